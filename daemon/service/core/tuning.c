/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/tuning.h"

#include "engine/machine.h"
#include "log/log.h"

#include <inttypes.h>
#include <sys/resource.h>

void tuning_raise_descriptors(const sheard_config *config) {
    const rlim_t needed =
        (rlim_t)(config->limits.connections + sheard_config_own_descriptors(config));
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < needed) {
        limit.rlim_cur = limit.rlim_max < needed ? limit.rlim_max : needed;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
    const int64_t connections = tuning_connections(config);
    if (connections < config->limits.connections) {
        log_warning("[limits] connections is %" PRId64 ", but there are file descriptors for "
                    "%" PRId64 " only: lower it, or raise LimitNOFILE",
                    config->limits.connections, connections);
    }
}

/* If there are very few descriptors, clients get a quarter of them; jobs then wait for each
 * other. */
int64_t tuning_connections(const sheard_config *config) {
    const int64_t configured = config->limits.connections;
    const int64_t own = sheard_config_own_descriptors(config);
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= (rlim_t)(configured + own))
        return configured;
    const int64_t there_are = (int64_t)limit.rlim_cur;
    const int64_t left = there_are - own;
    return left > there_are / 4 ? left : there_are / 4;
}

server_limits tuning_server(const sheard_config *c) {
    server_limits limits;
    server_limits_init(&limits);
    limits.connections = (size_t)tuning_connections(c);
    limits.user_connections = (size_t)c->limits.user_connections;
    limits.reserved_connections = (size_t)c->limits.admin_connections;
    limits.unsent_bytes = (size_t)c->limits.unsent_bytes;
    limits.in_flight = (size_t)c->limits.requests_in_flight;
    limits.idle_timeout_ms = c->limits.idle_timeout_ms;
    return limits;
}

int64_t tuning_memory(const sheard_config *c) {
    const int64_t machine = machine_memory();
    if (c->limits.memory_bytes > machine) {
        log_warning("[limits] memory is %lld bytes, but this service can have no more than %lld",
                    (long long)c->limits.memory_bytes, (long long)machine);
    }
    return c->limits.memory_bytes > 0 ? c->limits.memory_bytes : machine / 4;
}

reader_limits tuning_reader(const sheard_config *c) {
    return (reader_limits){.memory_bytes = c->reader.memory_bytes,
                           .cpu_seconds = (c->reader.cpu_time_ms + 999) / 1000,
                           .unpacked_bytes = c->reader.unpacked_bytes,
                           .scratch_bytes = c->reader.scratch_bytes,
                           .shared_bytes = c->reader.shared_memory_bytes,
                           .timeout_ms = (int)c->reader.wall_time_ms};
}

spool_tuning tuning_spool(const sheard_config *c) {
    return (spool_tuning){.settle_ms = c->spool.settle_time_ms,
                          .scan_ms = c->spool.scan_interval_ms,
                          .done = c->spool.done,
                          .failed = c->spool.failed};
}

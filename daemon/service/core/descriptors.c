/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/descriptors.h"

#include "log/log.h"

#include <inttypes.h>
#include <sys/resource.h>

void descriptors_raise(const sheard_config *config) {
    const rlim_t needed =
        (rlim_t)(config->limits.connections + sheard_config_own_descriptors(config));
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < needed) {
        limit.rlim_cur = limit.rlim_max < needed ? limit.rlim_max : needed;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
    const int64_t connections = descriptors_connections(config);
    if (connections < config->limits.connections) {
        log_warning("[limits] connections is %" PRId64 ", but there are file descriptors for "
                    "%" PRId64 " only: lower it, or raise LimitNOFILE",
                    config->limits.connections, connections);
    }
}

/* If there are very few descriptors, clients get a quarter of them; jobs then wait for each
 * other. */
int64_t descriptors_connections(const sheard_config *config) {
    const int64_t configured = config->limits.connections;
    const int64_t own = sheard_config_own_descriptors(config);
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= (rlim_t)(configured + own))
        return configured;
    const int64_t there_are = (int64_t)limit.rlim_cur;
    const int64_t left = there_are - own;
    return left > there_are / 4 ? left : there_are / 4;
}

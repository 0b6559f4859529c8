/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/open_parts.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "reader/program.h"
#include "reader/scratch.h"
#include "service/core/clock.h"
#include "service/core/descriptors.h"
#include "service/core/directory.h"
#include "service/core/owner.h"
#include "service/core/parts.h"
#include "service/core/processors.h"
#include "service/core/tuning.h"
#include "service/rpc/methods.h"

#include <stdio.h>
#include <string.h>

enum { CHECKPOINT_MS = 5000 };

/* ---- the store ---- */

static int check_owner(const service *s, shear_error *err) {
    const size_t i = (size_t)sheard_setting_find("daemon", "state_dir");
    return owner_check(s->config.daemon.state_dir, sheard_setting_at(i).initial, "sheard", err);
}

int open_store(service *s, shear_error *err) {
    char path[4200];
    const store_options options = {.busy_ms = 5000};
    TRY(check_owner(s, err));
    TRY(directory_make(s->config.daemon.state_dir, 0750, err));
    snprintf(path, sizeof path, "%s/sheard.db", s->config.daemon.state_dir);
    TRY(store_open(&s->store, path, &options, clock_wall_ms(), err));
    if (store_opened(s->store)->requeued > 0) {
        log_notice("%lld jobs were interrupted and go on",
                   (long long)store_opened(s->store)->requeued);
    }
    return SHEAR_OK;
}

/* ---- the engine ---- */

static void wake(void *context) {
    service *s = context;
    uv_async_send(&s->events.engine);
}

int open_engine(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    char program[4200];
    char copies[4200];
    const bool chosen = strcmp(c->reader.scratch, "auto") != 0;
    TRY(reader_find_program(program, sizeof program, err));
    TRY(scratch_find(copies, sizeof copies, chosen ? c->reader.scratch : "", c->daemon.state_dir,
                     err));
    reader_limits limits = tuning_reader(c);
    limits.program = program;
    limits.scratch = copies;
    const engine_options options = {.workers = c->daemon.workers > 0 ? (int)c->daemon.workers
                                                                     : processors_count(),
                                    .limits = limits,
                                    .checkpoint_ms = CHECKPOINT_MS,
                                    .memory_bytes = tuning_memory(c),
                                    .plans_count = c->plans.max_count,
                                    .plans_bytes = c->plans.max_bytes,
                                    .wake = wake,
                                    .context = s};
    return engine_new(&s->engine, &options, err);
}

/* ---- the server ---- */

static bool is_admin(void *context, const access_peer *peer) {
    const service *s = context;
    return permissions_is_admin(&s->permissions, peer);
}

int open_server(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    int fds[8];
    descriptors_raise(c);
    server_options options = {
        .path = c->daemon.socket,
        .mode = c->daemon.socket_mode,
        .group = c->daemon.socket_group,
        .fds = fds,
        .limits = tuning_server(c),
        .defaults = &c->measure,
        .handlers = {.request = methods_request, .is_admin = is_admin, .context = s}};
    TRY(server_activation(fds, 8, &options.n_fds, err));
    s->activated = s->activated || options.n_fds > 0;
    return server_open(&s->server, &s->loop, &options, err);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open and close the service, and connect its rooms by callbacks. */
#include "service/service.h"

#include "base/cleanup.h"
#include "engine/machine.h"
#include "log/log.h"
#include "reader/program.h"
#include "reader/scratch.h"
#include "service/core/clock.h"
#include "service/core/directory.h"
#include "service/core/parts.h"
#include "service/core/reload.h"
#include "service/core/tuning.h"
#include "service/fields/change_notifier.h"
#include "service/fields/estimates.h"
#include "service/fields/field_purge.h"
#include "service/intake/dropped_files.h"
#include "service/intake/file_disposal.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/catalog_directory.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/job_queue.h"
#include "service/loop.h"
#include "service/rpc/methods.h"
#include "service/rpc/pending_waits.h"
#include "service/rpc/probe.h"
#include "shear/version.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* ---- calls of rooms into those above them ---- */

static size_t running_jobs(const service *s) {
    return s->jobs->n;
}

/* Check that new catalogs can go into the new directory, if it has changed. */
static int check_reload(service *s, const sheard_config *fresh, shear_error *err) {
    const bool same = s->config.catalogs.enabled &&
                      strcmp(s->config.catalogs.directory, fresh->catalogs.directory) == 0;
    return fresh->catalogs.enabled && !same
               ? catalog_directory_claim(s, fresh->catalogs.directory, err)
               : SHEAR_OK;
}

static void on_turn_ended(void *context, int code) {
    service *s = context;
    if (code != SHEAR_OK) {
        s->jobs->may_have_orphans = true;
    } else {
        job_queue_fill(s);
    }
    lifecycle_check(s);
}

static void on_job_counted(service *s, const store_job *job) {
    change_notifier_note(s, job->field, job->settings_digest);
}

static const service_hooks hooks = {.running_jobs = running_jobs,
                                    .stop_jobs = job_queue_stop_all,
                                    .close = change_notifier_flush,
                                    .check_reload = check_reload,
                                    .dispose_file = file_disposal_end,
                                    .job_ended = pending_waits_job_ended,
                                    .job_counted = on_job_counted,
                                    .other_event = probe_event};

/* ---- the store ---- */

static int check_owner(const service *s, shear_error *err) {
    const size_t i = (size_t)sheard_setting_find("daemon", "state_dir");
    return directory_check_owner(s->config.daemon.state_dir, sheard_setting_at(i).initial, "sheard",
                                 err);
}

static int open_store(service *s, shear_error *err) {
    const store_options options = {.busy_ms = 5000};
    TRY(check_owner(s, err));
    TRY(directory_make(s->config.daemon.state_dir, 0750, err));
    snprintf(s->database, sizeof s->database, "%s/sheard.db", s->config.daemon.state_dir);
    TRY(store_open(&s->store, s->database, &options, clock_wall_ms(), err));
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

static int open_engine(service *s, shear_error *err) {
    enum { CHECKPOINT_MS = 5000 };
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
                                                                     : machine_processors(),
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

static int open_server(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    int fds[8];
    tuning_raise_descriptors(c);
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

/* ---- opening ---- */

/* All modules in one block of memory. */
typedef struct service_parts {
    service s; /* first */
    active_jobs jobs;
    estimates estimates;
    change_notifier notifier;
    field_purge purge;
    pending_waits waits;
    probe probe;
} service_parts;

static service *service_new(void) {
    service_parts *all = calloc(1, sizeof *all);
    if (all == NULL)
        return NULL;
    service *s = &all->s;
    s->jobs = &all->jobs;
    s->estimates = &all->estimates;
    s->notifier = &all->notifier;
    s->purge = &all->purge;
    s->waits = &all->waits;
    s->probe = &all->probe;
    s->hooks = &hooks;
    s->notify.fd = -1;
    s->started_wall_ms = clock_wall_ms();
    s->started_steady_ms = clock_steady_ms();
    uv_loop_init(&s->loop);
    loop_start(s);
    lifecycle_start(s);
    statistics_start(&s->statistics, &s->loop);
    estimates_init(s->estimates);
    change_notifier_init(s->notifier, s);
    field_purge_init(s->purge);
    pending_waits_init(s->waits);
    return s;
}

static int open_access(service *s, shear_error *err) {
    TRY(permissions_init(&s->permissions, &s->config, err));
    reload_warn_names(s);
    data_roots_init(&s->roots, &s->loop, &s->group, &s->life);
    return data_roots_set(&s->roots, &s->config.access.data_roots, err);
}

/* Open the store and the modules that need it. */
static int open_state(service *s, shear_error *err) {
    TRY(open_store(s, err));
    group_start(&s->group, &s->loop, s->store, &s->notes, on_turn_ended, s);
    TRY(clock_watch_start(&s->clock, &s->group, &s->config, err));
    TRY(catalogs_open(s, err));
    catalogs_remove_retracted(s);
    return SHEAR_OK;
}

/* A service that was killed while starting a reader may leave a child that holds its socket and
 * locks until it executes the reader. That takes a moment, and a restart may come sooner: try again
 * for PATIENCE_MS. */
static int open_when_left(service *s, int (*open_it)(service *s, shear_error *err), int taken,
                          shear_error *err) {
    enum { PATIENCE_MS = 2000, STEP_MS = 50 };
    const struct timespec step = {.tv_nsec = STEP_MS * 1000000L};
    int code = open_it(s, err);
    for (int waited = 0; code == taken && waited < PATIENCE_MS; waited += STEP_MS) {
        nanosleep(&step, NULL);
        code = open_it(s, err);
    }
    return code;
}

static int open_all(service *s, shear_error *err) {
    TRY(notify_init(&s->notify, err));
    TRY(open_access(s, err));
    TRY(open_state(s, err));
    TRY(open_engine(s, err));
    TRY(open_when_left(s, open_server, SHEAR_E_EXISTS, err));
    return open_when_left(s, dropped_files_open, SPOOL_LOCKED, err);
}

int service_open(service **out, sheard_config *config, const char *config_path,
                 const sheard_list *assignments, shear_error *err) {
    service *s = service_new();
    *out = NULL;
    if (s == NULL) {
        sheard_config_deinit(config);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    s->config = *config;
    user_names_write(geteuid(), s->user, sizeof s->user);
    s->config_path = config_path;
    s->assignments = assignments;
    const int code = open_all(s, err);
    if (code != SHEAR_OK) {
        service_close(s);
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

void service_run(service *s) {
    char sockets[1024]; /* may be systemd's, not the configured one */
    server_sockets(s->server, sockets, sizeof sockets);
    log_notice("sheard %s ready: socket %s, watch folder %s", SHEAR_VERSION_STRING, sockets,
               s->spool != NULL ? s->config.spool.directory : "none");
    notify_ready(&s->notify, "ready", NULL);
    job_queue_fill(s);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    log_notice("sheard stopped");
}

void service_close(service *s) {
    if (s == NULL)
        return;
    spool_close(s->spool);
    lifecycle_close(s, 0);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    engine_free(s->engine);
    change_notifier_deinit(s->notifier);
    estimates_deinit(s->estimates);
    field_purge_deinit(s->purge);
    active_jobs_deinit(s->jobs);
    store_close(s->store);
    permissions_deinit(&s->permissions);
    data_roots_deinit(&s->roots);
    notify_deinit(&s->notify);
    uv_loop_close(&s->loop);
    sheard_config_deinit(&s->config);
    free(s);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open and close the service, connect its rooms by callbacks, and run what is due once a second. */
#include "service/service.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/core/reload.h"
#include "service/fields/change_notifier.h"
#include "service/fields/estimates.h"
#include "service/fields/field_purge.h"
#include "service/intake/dropped_files.h"
#include "service/intake/file_disposal.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/catalog_directory.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/engine_events.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_queue.h"
#include "service/open_parts.h"
#include "service/rpc/field_message.h"
#include "service/rpc/pending_waits.h"
#include "service/rpc/probe.h"
#include "shear/version.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* ---- the callbacks of core ---- */

/* Retire a batch of finished jobs that exceed the configured age or number. */
static void retire_jobs(service *s) {
    const sheard_config *c = &s->config;
    shear_error ignored = {0};
    int64_t retired = 0;
    if (c->retention.jobs_max_age_ms <= 0 && c->retention.jobs_max_count <= 0)
        return;
    const store_retention rule = {
        .finished_before_ms = c->retention.jobs_max_age_ms > 0
                                  ? clock_watch_for_ages(&s->clock) - c->retention.jobs_max_age_ms
                                  : INT64_MIN,
        .keep = c->retention.jobs_max_count > 0 ? c->retention.jobs_max_count : -1,
        .batch = 1000};
    store_retire(s->store, &rule, &retired, &ignored);
}

static void tick(service *s) {
    enum { SPOOL_WAKE_S = 5 };
    shear_error ignored;
    clock_watch_look(&s->clock);
    statistics_tick(&s->statistics, engine_get_load(s->engine).stamps_total, s->jobs->ended);
    job_message_publish_progress(s);
    problem_notes_tick(&s->notes);
    pending_waits_tick(s);
    change_notifier_tick(s);
    data_roots_tick(&s->roots);
    field_purge_continue(s);
    log_flush();
    if (s->notify.watchdog_ms > 0)
        notify_watchdog(&s->notify, NULL);
    /* After a failed commit, commit an empty group to find out whether the disk works again. */
    if (group_is_failing(&s->group))
        group_begin(&s->group, &ignored);
    retire_jobs(s);
    if (s->spool != NULL && s->statistics.ticks % SPOOL_WAKE_S == 0)
        spool_wake(s->spool);
}

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

static const core_hooks core_calls = {.tick = tick,
                                      .engine_events = engine_events_process,
                                      .running_jobs = running_jobs,
                                      .stop_jobs = job_queue_stop_all,
                                      .close = change_notifier_flush,
                                      .check_reload = check_reload};

static void on_turn_ended(void *context, int code) {
    service *s = context;
    if (code != SHEAR_OK) {
        s->jobs->may_have_orphans = true;
    } else {
        job_queue_fill(s);
    }
    lifecycle_check(s);
}

/* ---- the callbacks of jobs ---- */

static void on_job_ended(service *s, const store_job *job) {
    pending_waits_job_ended(s, job->id);
}

static void on_job_counted(service *s, const store_job *job) {
    change_notifier_note(s, job->field, job->settings_digest);
}

static const job_hooks job_calls = {.dispose_file = file_disposal_end,
                                    .ended = on_job_ended,
                                    .counted = on_job_counted,
                                    .other_event = probe_event};

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
    s->hooks = &core_calls;
    s->jobs->hooks = &job_calls;
    s->notify.fd = -1;
    s->started_wall_ms = clock_wall_ms();
    s->started_steady_ms = clock_steady_ms();
    uv_loop_init(&s->loop);
    loop_start(s);
    lifecycle_start(s);
    statistics_start(&s->statistics, &s->loop);
    estimates_init(s->estimates);
    change_notifier_init(s->notifier, s, field_message_publish);
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
    const group_hooks turn = {.turn_ended = on_turn_ended, .context = s};
    TRY(open_store(s, err));
    group_start(&s->group, &s->loop, s->store, &s->notes, &turn);
    TRY(clock_watch_start(&s->clock, &s->group, &s->config, err));
    TRY(catalogs_open(s, err));
    catalogs_remove_retracted(s);
    return SHEAR_OK;
}

typedef int opener(service *s, shear_error *err);

/* A service that was killed while starting a reader may leave a child that holds its socket and
 * locks until it executes the reader. That takes a moment, and a restart may come sooner: try again
 * for PATIENCE_MS. */
static int open_when_left(service *s, opener *open_it, int taken, shear_error *err) {
    enum { PATIENCE_MS = 2000, STEP_MS = 50 };
    const struct timespec step = {.tv_nsec = STEP_MS * 1000000L};
    int code = open_it(s, err);
    for (int waited = 0; code == taken && waited < PATIENCE_MS; waited += STEP_MS) {
        nanosleep(&step, NULL);
        code = open_it(s, err);
    }
    return code;
}

static int open_server_when_left(service *s, shear_error *err) {
    return open_when_left(s, open_server, SHEAR_E_EXISTS, err);
}

static int open_spool_when_left(service *s, shear_error *err) {
    return open_when_left(s, dropped_files_open, SPOOL_LOCKED, err);
}

static int notify_open(service *s, shear_error *err) {
    return notify_init(&s->notify, err);
}

static int open_all(service *s, shear_error *err) {
    static opener *const openers[] = {notify_open, open_access,           open_state,
                                      open_engine, open_server_when_left, open_spool_when_left};
    for (size_t i = 0; i < sizeof openers / sizeof *openers; i++)
        TRY(openers[i](s, err));
    return SHEAR_OK;
}

static int copy_arguments(service *s, const char *config_path, const sheard_list *assignments,
                          shear_error *err) {
    s->config_path = config_path != NULL ? strdup(config_path) : NULL;
    for (size_t i = 0; i < assignments->n; i++)
        TRY(sheard_list_append(&s->assignments, assignments->items[i], err));
    return SHEAR_OK;
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
    int code = copy_arguments(s, config_path, assignments, err);
    code = code == SHEAR_OK ? open_all(s, err) : code;
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
    sheard_list_deinit(&s->assignments);
    sheard_config_deinit(&s->config);
    free(s->config_path);
    free(s);
}

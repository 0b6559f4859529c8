/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/loop.h"

#include "log/log.h"
#include "service/core/parts.h"
#include "service/core/reload.h"
#include "service/fields/change_notifier.h"
#include "service/fields/field_purge.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/engine_events.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_queue.h"
#include "service/rpc/pending_waits.h"

#include <math.h>
#include <signal.h>

static void on_signal(uv_signal_t *handle, int number) {
    service *s = handle->data;
    if (number == SIGHUP) {
        sheard_msg_reloaded reply;
        sheard_rpc_error error;
        reload_config(s, &reply, &error);
        reload_reply_deinit(&reply);
    } else if (s->life.state == SHEARD_SERVER_STOPPING) {
        log_notice("stopping at once: %zu jobs go on at the next start", s->jobs->n);
        job_queue_stop_all(s);
    } else {
        lifecycle_stop(s, NAN);
    }
}

static void on_engine(uv_async_t *async) {
    engine_events_process(async->data);
}

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

/* Do what is due once a second. */
static void on_tick(uv_timer_t *timer) {
    enum { SPOOL_WAKE_S = 5 };
    service *s = timer->data;
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
    if (s->group.failing)
        group_begin(&s->group, &ignored);
    retire_jobs(s);
    if (s->spool != NULL && s->statistics.ticks % SPOOL_WAKE_S == 0)
        spool_wake(s->spool);
}

void loop_start(service *s) {
    static const int numbers[LOOP_SIGNALS] = {SIGTERM, SIGINT, SIGHUP};
    loop_events *e = &s->events;
    uv_async_init(&s->loop, &e->engine, on_engine);
    uv_timer_init(&s->loop, &e->tick);
    e->engine.data = e->tick.data = s;
    uv_timer_start(&e->tick, on_tick, 1000, 1000);
    for (int i = 0; i < LOOP_SIGNALS; i++) {
        uv_signal_init(&s->loop, &e->signals[i]);
        e->signals[i].data = s;
        uv_signal_start(&e->signals[i], on_signal, numbers[i]);
    }
}

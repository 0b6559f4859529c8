/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop: its signals and timers, and how it comes to an end. */
#include "service/inner.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

enum { FLUSH_MS = 2000 };

/* ---- stopping ---- */

static void close_handle(uv_handle_t *handle) {
    if (uv_is_closing(handle) == 0) {
        uv_close(handle, NULL);
    }
}

/* The server is gone: close what is left, so that the loop ends. */
static void server_closed(void *context) {
    service *s = context;
    s->server = NULL;
    close_handle((uv_handle_t *)&s->engine_wake);
    close_handle((uv_handle_t *)&s->commit_check);
    close_handle((uv_handle_t *)&s->commit_now);
    close_handle((uv_handle_t *)&s->tick);
    close_handle((uv_handle_t *)&s->news_soon);
    close_handle((uv_handle_t *)&s->mark);
    close_handle((uv_handle_t *)&s->drain_end);
    for (int i = 0; i < 3; i++) {
        close_handle((uv_handle_t *)&s->signals[i]);
    }
}

void life_close(service *s, int64_t flush_ms) {
    if (s->server != NULL) {
        server_close(s->server, flush_ms, server_closed, s);
    } else {
        server_closed(s);
    }
}

sheard_msg_stopping life_left(service *s) {
    store_counts counts = {0};
    shear_error ignored;
    store_count(s->store, &counts, &ignored);
    return (sheard_msg_stopping){.state = s->state,
                                 .running = counts.jobs[STORE_RUNNING],
                                 .queued = counts.jobs[STORE_QUEUED] + counts.jobs[STORE_WAITING]};
}

void life_announce(service *s) {
    const sheard_notice_params params = {.server_state = life_left(s)};
    server_publish(s->server, SHEARD_NOTICE_SERVER_STATE, 0, NULL, &params);
}

void life_drain_queue(service *s) {
    if (s->state != SHEARD_SERVER_RUNNING) {
        return;
    }
    const sheard_msg_stopping left = life_left(s);
    s->state = SHEARD_SERVER_DRAINING;
    s->drain_pending = left.running + left.queued > 0;
    log_notice("draining: %lld jobs are left", (long long)(left.running + left.queued));
}

/* The last job of a drain has ended: tell it, once. */
static void check_drain(service *s) {
    if (s->state != SHEARD_SERVER_DRAINING || !s->drain_pending) {
        return;
    }
    const sheard_msg_stopping left = life_left(s);
    if (left.running + left.queued == 0 && s->first_after == NULL && !s->group_open) {
        s->drain_pending = false;
        log_notice("drained: no job is left");
        life_announce(s);
    }
}

void life_check(service *s) {
    check_drain(s);
    if (s->state != SHEARD_SERVER_STOPPING || s->n_active > 0 || s->first_after != NULL ||
        s->group_open || s->closing || s->server == NULL) {
        return;
    }
    s->closing = true;
    news_publish_all(s);
    spool_close(s->spool);
    s->spool = NULL;
    life_close(s, FLUSH_MS);
}

/* Give the running jobs back: their checkpoints are kept, and they go on at the next start. */
void life_stop_now(service *s) {
    s->state = SHEARD_SERVER_STOPPING;
    server_stop_accepting(s->server);
    life_announce(s);
    jobs_stop_all(s);
}

static void drain_over(uv_timer_t *timer) {
    service *s = timer->data;
    if (s->n_active > 0) {
        log_notice("the time to drain is over: %d jobs go on at the next start", s->n_active);
    }
    jobs_stop_all(s);
}

/* Take no new jobs, finish the running ones in the time that is given, then stop. */
void life_drain(service *s, double timeout_s) {
    const double seconds =
        isnan(timeout_s) ? 1e-3 * (double)s->config.daemon.drain_timeout_ms : timeout_s;
    if (s->state == SHEARD_SERVER_STOPPING) {
        return;
    }
    log_notice("stopping: %d running jobs have %.0f s to finish", s->n_active, seconds);
    s->state = SHEARD_SERVER_STOPPING;
    notify_stopping(&s->notify, "finishing the running jobs", NULL);
    life_announce(s);
    uv_timer_start(&s->drain_end, drain_over, (uint64_t)(1e3 * fmax(0.0, seconds)), 0);
}

/* ---- the loop's callbacks ---- */

static void on_signal(uv_signal_t *handle, int number) {
    service *s = handle->data;
    if (number == SIGHUP) {
        sheard_msg_reloaded reply;
        sheard_rpc_error error;
        reload_config(s, &reply, &error);
        reload_reply_deinit(&reply);
    } else if (s->state == SHEARD_SERVER_STOPPING) {
        log_notice("stopping at once: %d jobs go on at the next start", s->n_active);
        jobs_stop_all(s);
    } else {
        life_drain(s, NAN);
    }
}

static void on_engine(uv_async_t *async) {
    events_take(async->data);
}

/* Once a second. */
static void on_tick(uv_timer_t *timer) {
    service *s = timer->data;
    clock_look(s);
    status_tick(s);
    problems_tick(s);
    waits_expire(s);
    news_publish(s);
    roots_tick(s);
    forget_go_on(s);
    log_flush();
    if (s->notify.watchdog_ms > 0) {
        notify_watchdog(&s->notify, NULL);
    }
    /* After a failed commit the next try is due: an empty group tells whether the disk is well
     * again. */
    if (s->store_trouble_ms != 0) {
        shear_error ignored;
        group_begin(s, &ignored);
    }
    if (s->config.retention.jobs_max_age_ms > 0 || s->config.retention.jobs_max_count > 0) {
        shear_error err = {0};
        int64_t retired = 0;
        const sheard_config *c = &s->config;
        const store_retention rule = {
            .finished_before_ms = c->retention.jobs_max_age_ms > 0
                                      ? clock_for_ages(s) - c->retention.jobs_max_age_ms
                                      : INT64_MIN,
            .keep = c->retention.jobs_max_count > 0 ? c->retention.jobs_max_count : -1,
            .batch = 1000};
        store_retire(s->store, &rule, &retired, &err);
    }
    if (s->spool != NULL && s->ticks % 5 == 0) {
        spool_wake(s->spool);
    }
}

void life_start(service *s) {
    static const int numbers[3] = {SIGTERM, SIGINT, SIGHUP};
    uv_async_init(&s->loop, &s->engine_wake, on_engine);
    uv_timer_init(&s->loop, &s->tick);
    uv_timer_init(&s->loop, &s->drain_end);
    s->engine_wake.data = s->tick.data = s->drain_end.data = s;
    uv_timer_start(&s->tick, on_tick, 1000, 1000);
    uv_timer_init(&s->loop, &s->news_soon);
    s->news_soon.data = s;
    pace_start(s);
    for (int i = 0; i < 3; i++) {
        uv_signal_init(&s->loop, &s->signals[i]);
        s->signals[i].data = s;
        uv_signal_start(&s->signals[i], on_signal, numbers[i]);
    }
    group_start(s);
}

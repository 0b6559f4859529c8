/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/lifecycle.h"

#include "log/log.h"
#include "service/core/parts.h"

#include <inttypes.h>
#include <math.h>

enum { FLUSH_MS = 2000 };

sheard_msg_stopping lifecycle_get(service *s) {
    store_counts counts = {0};
    shear_error ignored;
    store_count(s->store, &counts, &ignored);
    return (sheard_msg_stopping){.state = s->life.state,
                                 .running = counts.jobs[STORE_RUNNING],
                                 .queued = counts.jobs[STORE_QUEUED] + counts.jobs[STORE_WAITING]};
}

void lifecycle_announce(service *s) {
    const sheard_notice_params params = {.server_state = lifecycle_get(s)};
    server_publish(s->server, SHEARD_NOTICE_SERVER_STATE, 0, NULL, &params);
}

/* ---- draining ---- */

void lifecycle_drain(service *s) {
    if (s->life.state != SHEARD_SERVER_RUNNING)
        return;
    const sheard_msg_stopping left = lifecycle_get(s);
    s->life.state = SHEARD_SERVER_DRAINING;
    s->life.drain_pending = left.running + left.queued > 0;
    log_notice("draining: %" PRId64 " jobs are left", left.running + left.queued);
}

/* Announce, once, that the last job of a drain has ended. */
static void check_drain(service *s) {
    if (s->life.state != SHEARD_SERVER_DRAINING || !s->life.drain_pending)
        return;
    const sheard_msg_stopping left = lifecycle_get(s);
    if (left.running + left.queued == 0 && group_is_idle(&s->group)) {
        s->life.drain_pending = false;
        log_notice("drained: no job is left");
        lifecycle_announce(s);
    }
}

/* ---- stopping ---- */

static void on_drain_end(uv_timer_t *timer) {
    service *s = timer->data;
    const size_t running = s->hooks->running_jobs(s);
    if (running > 0)
        log_notice("the time to drain is over: %zu jobs go on at the next start", running);
    s->hooks->stop_jobs(s);
}

void lifecycle_start(service *s) {
    uv_timer_init(&s->loop, &s->life.drain_end);
    s->life.drain_end.data = s;
}

void lifecycle_stop(service *s, double timeout_s) {
    const double seconds =
        isnan(timeout_s) ? 1e-3 * (double)s->config.daemon.drain_timeout_ms : timeout_s;
    if (s->life.state == SHEARD_SERVER_STOPPING)
        return;
    log_notice("stopping: %zu running jobs have %.0f s to finish", s->hooks->running_jobs(s),
               seconds);
    s->life.state = SHEARD_SERVER_STOPPING;
    notify_stopping(&s->notify, "finishing the running jobs", NULL);
    lifecycle_announce(s);
    uv_timer_start(&s->life.drain_end, on_drain_end, (uint64_t)(1e3 * fmax(0.0, seconds)), 0);
}

/* Running jobs are put back into the queue; they resume from their checkpoints at the next
 * start. */
void lifecycle_stop_now(service *s) {
    s->life.state = SHEARD_SERVER_STOPPING;
    server_stop_accepting(s->server);
    lifecycle_announce(s);
    s->hooks->stop_jobs(s);
}

/* ---- the end ---- */

static void close_handle(uv_handle_t *handle, void *context) {
    (void)context;
    if (!uv_is_closing(handle))
        uv_close(handle, NULL);
}

/* The server is closed: close all other handles, so that the loop ends. */
static void server_closed(void *context) {
    service *s = context;
    s->server = NULL;
    uv_walk(&s->loop, close_handle, NULL);
}

void lifecycle_close(service *s, int64_t flush_ms) {
    if (s->server != NULL) {
        server_close(s->server, flush_ms, server_closed, s);
    } else {
        server_closed(s);
    }
}

void lifecycle_check(service *s) {
    check_drain(s);
    if (s->life.state != SHEARD_SERVER_STOPPING || s->hooks->running_jobs(s) > 0 ||
        !group_is_idle(&s->group) || s->life.closing || s->server == NULL) {
        return;
    }
    s->life.closing = true;
    s->hooks->close(s);
    spool_close(s->spool);
    s->spool = NULL;
    lifecycle_close(s, FLUSH_MS);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clients that wait for jobs to end. */
#include "service/inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void waiter_free(waiter *w) {
    free(w->ids);
    free(w);
}

/* All jobs of a waiter as they are now; how many have ended. */
static size_t look(service *s, const waiter *w, store_job *jobs, shear_msg_job *messages) {
    shear_error ignored;
    size_t ended = 0;
    for (size_t i = 0; i < w->n_ids; i++) {
        jobs[i] = (store_job){0};
        if (store_job_get(s->store, w->ids[i], &jobs[i], &ignored) != SHEAR_OK) {
            messages[i] = (shear_msg_job){.id = w->ids[i], .state = -1};
            ended++;
            continue;
        }
        present_job(s, &jobs[i], &messages[i]);
        ended += shear_job_state_is_final(jobs[i].state);
    }
    return ended;
}

/* Reply where all have ended, or `now`. Whether it was answered. */
static bool answer(service *s, waiter *w, bool now) {
    store_job *jobs = calloc(w->n_ids, sizeof *jobs);
    shear_msg_job *messages = calloc(w->n_ids, sizeof *messages);
    bool answered = false;
    if (jobs != NULL && messages != NULL) {
        w->left = w->n_ids - look(s, w, jobs, messages);
        const bool all = w->left == 0;
        if (all || now) {
            shear_reply reply = {0};
            if (w->method == SHEAR_METHOD_SUBMIT) {
                reply.submit = (shear_msg_submitted){.job = messages[0], .known = w->known};
            } else {
                reply.wait =
                    (shear_msg_waited){.jobs = messages, .n_jobs = w->n_ids, .timed_out = !all};
            }
            server_reply(s->server, w->to, &reply);
            answered = true;
        }
        for (size_t i = 0; i < w->n_ids; i++) {
            present_job_free(&messages[i]);
            store_job_deinit(&jobs[i]);
        }
    }
    free(jobs);
    free(messages);
    return answered;
}

void waits_add(service *s, server_handle to, int method, bool known, const int64_t *ids, size_t n,
               double timeout_s) {
    waiter *w = calloc(1, sizeof *w);
    if (w != NULL) {
        const double limit_s = 1e-3 * (double)s->config.limits.wait_timeout_ms;
        const double wanted_s = isnan(timeout_s) ? limit_s : timeout_s;
        *w = (waiter){.to = to,
                      .method = method,
                      .known = known,
                      .until_ms =
                          (int64_t)uv_now(&s->loop) +
                          (int64_t)(1e3 * (limit_s > 0 ? fmin(wanted_s, limit_s) : wanted_s)),
                      .n_ids = n,
                      .ids = malloc(n * sizeof *ids)};
        if (limit_s <= 0 && isnan(timeout_s)) {
            w->until_ms = INT64_MAX;
        }
    }
    if (w == NULL || w->ids == NULL) {
        shear_rpc_error error;
        shear_rpc_fail(&error, SHEAR_RPC_OUT_OF_MEMORY, NULL, "out of memory for a wait");
        server_reply_error(s->server, to, &error);
        free(w);
        return;
    }
    memcpy(w->ids, ids, n * sizeof *ids);
    if (answer(s, w, w->until_ms <= (int64_t)uv_now(&s->loop))) {
        waiter_free(w);
        return;
    }
    w->next = s->waiters;
    s->waiters = w;
}

static bool waits_for(const waiter *w, int64_t id) {
    for (size_t i = 0; i < w->n_ids; i++) {
        if (w->ids[i] == id) {
            return true;
        }
    }
    return false;
}

/* Drop the waiters for which `answered` holds. */
static void sweep(service *s, bool (*over)(service *, waiter *, int64_t), int64_t argument) {
    for (waiter **at = &s->waiters; *at != NULL;) {
        waiter *w = *at;
        if (over(s, w, argument)) {
            *at = w->next;
            waiter_free(w);
        } else {
            at = &w->next;
        }
    }
}

/* The store is asked only when it may be the last one: many clients may wait for many jobs. It may
 * turn out not to be: a job that had failed may have been retried meanwhile. */
static bool over_with_job(service *s, waiter *w, int64_t id) {
    if (!waits_for(w, id)) {
        return false;
    }
    w->left -= w->left > 0;
    return w->left == 0 && answer(s, w, false);
}

static bool over_by_time(service *s, waiter *w, int64_t now) {
    return w->until_ms <= now && (answer(s, w, true), true);
}

static bool over_with_connection(service *s, waiter *w, int64_t connection) {
    (void)s;
    return w->to.connection == (uint64_t)connection;
}

static bool always(service *s, waiter *w, int64_t nothing) {
    (void)s;
    (void)w;
    (void)nothing;
    return true;
}

void waits_job_ended(service *s, int64_t id) {
    sweep(s, over_with_job, id);
}

void waits_expire(service *s) {
    sweep(s, over_by_time, (int64_t)uv_now(&s->loop));
}

void waits_forget(service *s, uint64_t connection) {
    sweep(s, over_with_connection, (int64_t)connection);
}

void waits_free(service *s) {
    sweep(s, always, 0);
}

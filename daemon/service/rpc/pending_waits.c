/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clients that wait for jobs to end (wait, submit with wait). Each is deferred work of the server:
 * it looks at its jobs' states; where some are not final, it sleeps until the last of them ends, or
 * its time is over; then its reply is made, a few jobs at a time. The store is asked no more often
 * than that: many clients may wait for many jobs. */
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LOOKS_A_STEP = 64, JOBS_A_STEP = 8 };
/* Ids that all waits of a user, and all of all users, may name. */
enum { USER_IDS = 1 << 18, ALL_IDS = 1 << 20 };

enum phase { LOOKING, SLEEPING, REPLYING };

struct waiter {
    listing list; /* first; of submit only `s` and `to` are used */
    TAILQ_ENTRY(waiter) link;
    wait_user *user;
    int method;
    bool known;       /* of submit: the key had been seen */
    int64_t until_ms; /* loop time; INT64_MAX: for ever */
    int phase;
    size_t n_ids, next; /* the next id to look at, or to reply with */
    const int64_t *ids; /* as asked for: the request's, or `one` */
    int64_t one;
    size_t left;      /* of them, not final when they were looked at, and not ended since */
    int64_t *pending; /* [n_pending] those, ascending */
    size_t n_pending;
    bool looked, timed_out;
};

/* ---- whose they are ---- */

static wait_user *find_user(service *s, uid_t uid) {
    wait_user *u;
    TAILQ_FOREACH(u, &s->wait_users, link) {
        if (u->uid == uid) {
            return u;
        }
    }
    u = calloc(1, sizeof *u);
    if (u != NULL) {
        u->uid = uid;
        TAILQ_INSERT_TAIL(&s->wait_users, u, link);
    }
    return u;
}

static void count_ids(service *s, wait_user *u, size_t n, bool more) {
    if (u == NULL) {
        return;
    }
    u->ids = more ? u->ids + n : u->ids - n;
    s->wait_ids = more ? s->wait_ids + n : s->wait_ids - n;
    if (u->ids == 0) {
        TAILQ_REMOVE(&s->wait_users, u, link);
        free(u);
    }
}

/* ---- one of them ---- */

static void fall_asleep(waiter *w) {
    w->phase = SLEEPING;
    TAILQ_INSERT_TAIL(&w->list.s->waiters, w, link);
}

static void wake_up(waiter *w) {
    TAILQ_REMOVE(&w->list.s->waiters, w, link);
    w->phase = LOOKING;
    w->next = w->n_pending = 0;
    server_wake(w->list.s->server, w->list.to);
}

static void waiter_drop(void *context) {
    waiter *w = context;
    if (w->phase == SLEEPING) {
        TAILQ_REMOVE(&w->list.s->waiters, w, link);
    }
    count_ids(w->list.s, w->user, w->n_ids, false);
    listing_deinit(&w->list);
    free(w->pending);
    free(w);
}

static int ascending(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a;
    const int64_t y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static bool is_over(const waiter *w) {
    return w->until_ms <= (int64_t)uv_now(&w->list.s->loop);
}

/* The states of some of them; the last of these steps says how it goes on. */
static int look(waiter *w) {
    const size_t end = w->n_ids - w->next > LOOKS_A_STEP ? w->next + LOOKS_A_STEP : w->n_ids;
    for (; w->next < end; w->next++) {
        shear_error err = {0};
        enum store_state state = STORE_QUEUED;
        const int code = store_job_state(w->list.s->store, w->ids[w->next], &state, &err);
        if (code != SHEAR_OK && !w->looked) {
            method_refuse_store(w->list.s, w->list.to, code, &err);
            return SERVER_PAUSE;
        }
        if (code == SHEAR_OK && !sheard_job_state_is_final(state)) {
            w->pending[w->n_pending++] = w->ids[w->next];
        }
    }
    if (w->next < w->n_ids) {
        return SERVER_MORE;
    }
    w->looked = true;
    w->left = w->n_pending;
    if (w->left > 0 && !is_over(w)) {
        qsort(w->pending, w->n_pending, sizeof *w->pending, ascending);
        fall_asleep(w);
        return SERVER_PAUSE;
    }
    w->phase = REPLYING;
    w->next = 0;
    w->timed_out = false;
    return SERVER_MORE;
}

/* A job as it is now; one that has been forgotten meanwhile has no state. */
static bool add_job(waiter *w, int64_t id) {
    store_job job = {0};
    shear_error ignored;
    sheard_msg_job message = {.id = id, .state = -1};
    const bool found = store_job_get(w->list.s->store, id, &job, &ignored) == SHEAR_OK;
    bool good = true;
    if (found) {
        present_job(w->list.s, &job, &message);
        w->timed_out |= !sheard_job_state_is_final(job.state);
    }
    if (w->method == SHEARD_METHOD_SUBMIT) {
        const sheard_reply reply = {.submit = {.job = message, .known = w->known}};
        server_reply(w->list.s->server, w->list.to, &reply);
    } else {
        good = listing_add(&w->list, &message);
    }
    present_job_free(&message);
    store_job_deinit(&job);
    return good;
}

static int waiter_step(void *context) {
    waiter *w = context;
    if (w->phase == LOOKING) {
        return look(w);
    }
    const size_t end = w->n_ids - w->next > JOBS_A_STEP ? w->next + JOBS_A_STEP : w->n_ids;
    while (w->next < end && add_job(w, w->ids[w->next])) {
        w->next++;
    }
    if (w->next == w->n_ids && w->method == SHEARD_METHOD_WAIT) {
        const sheard_reply rest = {.wait.timed_out = w->timed_out};
        listing_reply(&w->list, &rest);
    }
    return SERVER_MORE;
}

/* ---- beginning to wait ---- */

static int64_t end_of_wait(const service *s, double timeout_s) {
    const double limit_s = 1e-3 * (double)s->config.limits.wait_timeout_ms;
    const double wanted_s = isnan(timeout_s) ? limit_s : timeout_s;
    if (limit_s <= 0 && isnan(timeout_s)) {
        return INT64_MAX;
    }
    return (int64_t)uv_now(&s->loop) +
           (int64_t)(1e3 * (limit_s > 0 ? fmin(wanted_s, limit_s) : wanted_s));
}

static waiter *waiter_new(const service *s, int method, size_t n, double timeout_s) {
    waiter *w = calloc(1, sizeof *w);
    if (w != NULL) {
        w->pending = malloc(n * sizeof *w->pending);
    }
    if (w == NULL || w->pending == NULL) {
        free(w);
        return NULL;
    }
    w->method = method;
    w->until_ms = end_of_wait(s, timeout_s);
    w->n_ids = n;
    return w;
}

static void refuse(service *s, server_handle to) {
    method_refuse(s, to, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a wait");
}

void method_wait(service *s, const server_request *r) {
    const sheard_msg_wait *p = &r->request->params.wait;
    wait_user *u = find_user(s, r->peer->uid);
    if (u != NULL && u->ids > 0 &&
        (u->ids + p->n_ids > USER_IDS || s->wait_ids + p->n_ids > ALL_IDS)) {
        sheard_rpc_error error;
        sheard_rpc_fail(&error, SHEARD_RPC_TOO_MANY_REQUESTS, "wait for fewer jobs at a time",
                        "your waits name %zu jobs; %d are taken of a user, %d of all", u->ids,
                        (int)USER_IDS, (int)ALL_IDS);
        server_reply_error(s->server, r->handle, &error);
        return;
    }
    waiter *w = u != NULL ? waiter_new(s, SHEARD_METHOD_WAIT, p->n_ids, p->timeout_s) : NULL;
    count_ids(s, u, w != NULL ? w->n_ids : 0, true);
    if (w == NULL) {
        refuse(s, r->handle);
        return;
    }
    w->user = u;
    w->ids = p->ids;
    listing_begin(&w->list, s, r, waiter_step, waiter_drop);
}

void waits_for_submitted(service *s, server_handle to, bool known, int64_t id) {
    waiter *w = waiter_new(s, SHEARD_METHOD_SUBMIT, 1, NAN);
    if (w == NULL) {
        refuse(s, to);
        return;
    }
    const server_work work = {.step = waiter_step, .drop = waiter_drop, .context = w};
    w->list = (listing){.s = s, .to = to};
    w->one = id;
    w->ids = &w->one;
    w->known = known;
    server_defer(s->server, to, &work);
}

/* ---- waking up ---- */

static bool waits_for(const waiter *w, int64_t id) {
    return id >= w->pending[0] && id <= w->pending[w->n_pending - 1] &&
           bsearch(&id, w->pending, w->n_pending, sizeof id, ascending) != NULL;
}

/* It may turn out not to be the last one: a job that had failed may have been retried meanwhile. */
void waits_job_ended(service *s, int64_t id) {
    waiter *next;
    for (waiter *w = TAILQ_FIRST(&s->waiters); w != NULL; w = next) {
        next = TAILQ_NEXT(w, link);
        if (waits_for(w, id)) {
            w->left -= w->left > 0;
            if (w->left == 0) {
                wake_up(w);
            }
        }
    }
}

void waits_expire(service *s) {
    waiter *next;
    for (waiter *w = TAILQ_FIRST(&s->waiters); w != NULL; w = next) {
        next = TAILQ_NEXT(w, link);
        if (is_over(w)) {
            wake_up(w);
        }
    }
}

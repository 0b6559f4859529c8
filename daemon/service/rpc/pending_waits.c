/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/pending_waits.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/job_message.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"

#include <assert.h>
#include <math.h>

enum { LOOKS_A_STEP = 64, JOBS_A_STEP = 8 };
/* Most jobs in the waits of one user, and of all users. */
enum { USER_IDS = 1 << 18, ALL_IDS = 1 << 20 };

enum wait_phase { WAIT_LOOKING, WAIT_SLEEPING, WAIT_REPLYING };

typedef struct pending_wait {
    listing list; /* first; a submit has no request */
    TAILQ_ENTRY(pending_wait) link;
    uid_t uid;
    bool submit;      /* the method is submit; else wait */
    bool known;       /* of submit: the idempotency key had been used before */
    int64_t until_ms; /* loop time; INT64_MAX: no limit */
    enum wait_phase phase;
    size_t n_ids, next; /* index of the next id to read or to reply with */
    const int64_t *ids; /* [n_ids], the request's, or &one */
    int64_t one;
    size_t left;      /* number of jobs that were unfinished when read and have not ended since */
    size_t n_pending; /* number of jobs that were unfinished when read */
    bool looked, timed_out;
    int64_t pending[]; /* [n_pending], with memory for n_ids: those jobs, ascending */
} pending_wait;

void pending_waits_init(pending_waits *all) {
    TAILQ_INIT(&all->first);
}

/* ---- one wait ---- */

static void wake_up(pending_wait *w) {
    w->phase = WAIT_LOOKING;
    w->next = w->n_pending = 0;
    server_wake(w->list.s->server, w->list.to);
}

static void wait_deinit(listing *l) {
    pending_wait *w = (pending_wait *)l;
    pending_waits *all = l->s->waits;
    TAILQ_REMOVE(&all->first, w, link);
    all->ids -= w->submit ? 0 : w->n_ids;
}

static int ascending(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a;
    const int64_t y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static bool is_over(const pending_wait *w) {
    return w->until_ms <= (int64_t)uv_now(&w->list.s->loop);
}

/* Read the states of some jobs; after the last of them, sleep or reply. */
static int look(pending_wait *w, sheard_rpc_error *error) {
    const size_t end = w->n_ids - w->next > LOOKS_A_STEP ? w->next + LOOKS_A_STEP : w->n_ids;
    for (; w->next < end; w->next++) {
        shear_error err = {0};
        enum store_state state = STORE_QUEUED;
        const int code = store_job_state(w->list.s->store, w->ids[w->next], &state, &err);
        if (!w->looked)
            TRY(rpc_error_from_store(error, code, &err));
        if (code == SHEAR_OK && !store_state_is_final(state))
            w->pending[w->n_pending++] = w->ids[w->next];
    }
    if (w->next < w->n_ids)
        return SHEARD_RPC_OK;
    w->looked = true;
    w->left = w->n_pending;
    if (w->left > 0 && !is_over(w)) {
        qsort(w->pending, w->n_pending, sizeof *w->pending, ascending);
        w->phase = WAIT_SLEEPING;
        return LISTING_PAUSE;
    }
    w->phase = WAIT_REPLYING;
    w->next = 0;
    w->timed_out = false;
    return SHEARD_RPC_OK;
}

/* Reply with a job as it is now. A job that was retired meanwhile has no state. */
static int add_job(pending_wait *w, int64_t id, sheard_rpc_error *error) {
    service *s = w->list.s;
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(job_message_deinit) sheard_msg_job message = {.id = id, .state = -1};
    shear_error ignored;
    if (store_job_get(s->store, id, &job, &ignored) == SHEAR_OK) {
        job_to_message(s, &job, &message);
        w->timed_out |= !store_state_is_final(job.state);
    }
    if (!w->submit)
        return listing_add(&w->list, &message, error);
    const sheard_reply reply = {.submit = {.job = message, .known = w->known}};
    server_reply(s->server, w->list.to, &reply);
    return SHEARD_RPC_OK;
}

static int wait_step(listing *l, sheard_rpc_error *error) {
    pending_wait *w = (pending_wait *)l;
    if (w->phase == WAIT_LOOKING)
        return look(w, error);
    const size_t end = w->n_ids - w->next > JOBS_A_STEP ? w->next + JOBS_A_STEP : w->n_ids;
    for (; w->next < end; w->next++)
        TRY(add_job(w, w->ids[w->next], error));
    if (w->next < w->n_ids || w->submit)
        return SHEARD_RPC_OK;
    const sheard_reply rest = {.wait.timed_out = w->timed_out};
    return listing_reply(l, &rest, error);
}

/* ---- begin to wait ---- */

static int64_t end_of_wait(const service *s, double timeout_s) {
    const double limit_s = 1e-3 * (double)s->config.limits.wait_timeout_ms;
    const double wanted_s = isnan(timeout_s) ? limit_s : timeout_s;
    if (limit_s <= 0 && isnan(timeout_s))
        return INT64_MAX;
    return (int64_t)uv_now(&s->loop) +
           (int64_t)(1e3 * (limit_s > 0 ? fmin(wanted_s, limit_s) : wanted_s));
}

static pending_wait *wait_new(service *s, server_handle to, sheard_request *request, size_t n,
                              double timeout_s, sheard_rpc_error *error) {
    static const listing_kind waits = {.what = "a wait", .step = wait_step, .deinit = wait_deinit};
    const size_t size = sizeof(pending_wait) + n * sizeof(int64_t);
    pending_wait *w = listing_new(s, to, request, &waits, size, error);
    if (w == NULL)
        return NULL;
    w->until_ms = end_of_wait(s, timeout_s);
    w->n_ids = n;
    TAILQ_INSERT_TAIL(&s->waits->first, w, link);
    return w;
}

/* Check that n more jobs may be waited for. A user who waits for none may wait for any number. */
static int check_number(const pending_waits *all, uid_t uid, size_t n, sheard_rpc_error *error) {
    size_t users = 0;
    const pending_wait *w;
    if (all->ids + n <= USER_IDS)
        return SHEARD_RPC_OK; /* there is no need to look at all waits, which may be very many */
    TAILQ_FOREACH(w, &all->first, link) {
        users += w->submit || w->uid != uid ? 0 : w->n_ids;
    }
    if (users == 0 || (users + n <= USER_IDS && all->ids + n <= ALL_IDS))
        return SHEARD_RPC_OK;
    return sheard_rpc_fail(
        error, SHEARD_RPC_TOO_MANY_REQUESTS, "wait for fewer jobs at a time",
        "your requests wait for %zu jobs; at most %d are accepted per user, %d in all", users,
        (int)USER_IDS, (int)ALL_IDS);
}

int method_wait(service *s, const server_request *r, sheard_rpc_error *error) {
    const sheard_msg_wait p = r->request->params.wait;
    assert(p.n_ids > 0);
    TRY(check_number(s->waits, r->peer->uid, p.n_ids, error));
    pending_wait *w = wait_new(s, r->handle, r->request, p.n_ids, p.timeout_s, error);
    if (w == NULL)
        return error->code;
    w->uid = r->peer->uid;
    w->ids = p.ids;
    s->waits->ids += p.n_ids;
    listing_begin(&w->list);
    return SHEARD_RPC_OK;
}

void pending_waits_add_submitted(service *s, server_handle to, bool known, int64_t id) {
    sheard_rpc_error error;
    pending_wait *w = wait_new(s, to, NULL, 1, NAN, &error);
    if (w == NULL) {
        server_reply_error(s->server, to, &error);
        return;
    }
    w->submit = true;
    w->known = known;
    w->one = id;
    w->ids = &w->one;
    listing_begin(&w->list);
}

/* ---- wake up ---- */

static bool waits_for(const pending_wait *w, int64_t id) {
    return w->phase == WAIT_SLEEPING && id >= w->pending[0] && id <= w->pending[w->n_pending - 1] &&
           bsearch(&id, w->pending, w->n_pending, sizeof id, ascending) != NULL;
}

/* Wake the waits whose last job has ended. They read the states again, since a job that had failed
 * may have been retried. */
void pending_waits_job_ended(service *s, const store_job *job) {
    pending_wait *w;
    TAILQ_FOREACH(w, &s->waits->first, link) {
        if (!waits_for(w, job->id))
            continue;
        if (w->left > 0)
            w->left--;
        if (w->left == 0)
            wake_up(w);
    }
}

void pending_waits_tick(service *s) {
    pending_wait *w;
    TAILQ_FOREACH(w, &s->waits->first, link) {
        if (w->phase == WAIT_SLEEPING && is_over(w))
            wake_up(w);
    }
}

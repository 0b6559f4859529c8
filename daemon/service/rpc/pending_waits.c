/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/pending_waits.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/job_message.h"
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"

#include <assert.h>
#include <math.h>

enum { LOOKS_A_STEP = 64, JOBS_A_STEP = 8 };
/* Most jobs in the waits of one user, and of all users. */
enum { USER_IDS = 1 << 18, ALL_IDS = 1 << 20 };

enum wait_phase { WAIT_LOOKING, WAIT_SLEEPING, WAIT_REPLYING };

/* A user, and the number of jobs in the user's waits. */
typedef struct wait_user {
    TAILQ_ENTRY(wait_user) link;
    uid_t uid;
    size_t ids;
} wait_user;

typedef struct pending_wait {
    listing list; /* first; of a submit only `s` and `to` are used */
    TAILQ_ENTRY(pending_wait) link;
    wait_user *user;  /* NULL: a submit */
    bool submit;      /* the method is submit; else wait */
    bool known;       /* of submit: the idempotency key had been used before */
    int64_t until_ms; /* loop time; INT64_MAX: no limit */
    enum wait_phase phase;
    size_t n_ids, next; /* index of the next id to read or to reply with */
    const int64_t *ids; /* [n_ids], the request's, or &one */
    int64_t one;
    size_t left;      /* number of jobs that were unfinished when read and have not ended since */
    int64_t *pending; /* [n_pending] numbers of those jobs, ascending, owned */
    size_t n_pending;
    bool looked, timed_out;
} pending_wait;

void pending_waits_init(pending_waits *all) {
    TAILQ_INIT(&all->asleep);
    TAILQ_INIT(&all->users);
}

/* ---- users ---- */

static wait_user *find_user(pending_waits *all, uid_t uid) {
    wait_user *u;
    TAILQ_FOREACH(u, &all->users, link) {
        if (u->uid == uid)
            return u;
    }
    u = calloc(1, sizeof *u);
    if (u != NULL) {
        u->uid = uid;
        TAILQ_INSERT_TAIL(&all->users, u, link);
    }
    return u;
}

static void add_ids(pending_waits *all, wait_user *u, size_t n) {
    u->ids += n;
    all->ids += n;
}

/* Free the user's record when none of the user's waits is left. */
static void remove_ids(pending_waits *all, wait_user *u, size_t n) {
    assert(n <= u->ids && n <= all->ids);
    u->ids -= n;
    all->ids -= n;
    if (u->ids == 0) {
        TAILQ_REMOVE(&all->users, u, link);
        free(u);
    }
}

/* ---- one wait ---- */

static void fall_asleep(pending_wait *w) {
    w->phase = WAIT_SLEEPING;
    TAILQ_INSERT_TAIL(&w->list.s->waits->asleep, w, link);
}

static void wake_up(pending_wait *w) {
    TAILQ_REMOVE(&w->list.s->waits->asleep, w, link);
    w->phase = WAIT_LOOKING;
    w->next = w->n_pending = 0;
    server_wake(w->list.s->server, w->list.to);
}

static void wait_drop(void *context) {
    pending_wait *w = context;
    if (w->phase == WAIT_SLEEPING)
        TAILQ_REMOVE(&w->list.s->waits->asleep, w, link);
    if (w->user != NULL)
        remove_ids(w->list.s->waits, w->user, w->n_ids);
    listing_deinit(&w->list);
    free(w->pending);
    free(w);
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
static enum server_step look(pending_wait *w) {
    const size_t end = w->n_ids - w->next > LOOKS_A_STEP ? w->next + LOOKS_A_STEP : w->n_ids;
    for (; w->next < end; w->next++) {
        shear_error err = {0};
        enum store_state state = STORE_QUEUED;
        const int code = store_job_state(w->list.s->store, w->ids[w->next], &state, &err);
        if (code != SHEAR_OK && !w->looked) {
            refuse_store(w->list.s, w->list.to, code, &err);
            return SERVER_PAUSE;
        }
        const bool unfinished = code == SHEAR_OK && !store_state_is_final(state);
        if (unfinished)
            w->pending[w->n_pending++] = w->ids[w->next];
    }
    if (w->next < w->n_ids)
        return SERVER_MORE;
    w->looked = true;
    w->left = w->n_pending;
    if (w->left > 0 && !is_over(w)) {
        qsort(w->pending, w->n_pending, sizeof *w->pending, ascending);
        fall_asleep(w);
        return SERVER_PAUSE;
    }
    w->phase = WAIT_REPLYING;
    w->next = 0;
    w->timed_out = false;
    return SERVER_MORE;
}

/* Reply with a job as it is now. A job that was retired meanwhile has no state. */
static bool add_job(pending_wait *w, int64_t id) {
    service *s = w->list.s;
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(job_message_deinit) sheard_msg_job message = {.id = id, .state = -1};
    shear_error ignored;
    if (store_job_get(s->store, id, &job, &ignored) == SHEAR_OK) {
        job_to_message(s, &job, &message);
        w->timed_out |= !store_state_is_final(job.state);
    }
    if (!w->submit)
        return listing_add(&w->list, &message);
    const sheard_reply reply = {.submit = {.job = message, .known = w->known}};
    server_reply(s->server, w->list.to, &reply);
    return true;
}

static enum server_step wait_step(void *context) {
    pending_wait *w = context;
    if (w->phase == WAIT_LOOKING)
        return look(w);
    const size_t end = w->n_ids - w->next > JOBS_A_STEP ? w->next + JOBS_A_STEP : w->n_ids;
    while (w->next < end && add_job(w, w->ids[w->next]))
        w->next++;
    if (w->next == w->n_ids && !w->submit) {
        const sheard_reply rest = {.wait.timed_out = w->timed_out};
        listing_reply(&w->list, &rest);
    }
    return SERVER_MORE;
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

static pending_wait *wait_new(const service *s, size_t n, double timeout_s) {
    pending_wait *w = calloc(1, sizeof *w);
    int64_t *pending = malloc(n * sizeof *pending);
    if (w == NULL || pending == NULL) {
        free(w);
        free(pending);
        return NULL;
    }
    w->pending = pending;
    w->until_ms = end_of_wait(s, timeout_s);
    w->n_ids = n;
    return w;
}

static void refuse_memory(service *s, server_handle to) {
    refuse_with(s, to, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a wait");
}

static void refuse_many(service *s, server_handle to, size_t ids) {
    sheard_rpc_error error;
    sheard_rpc_fail(&error, SHEARD_RPC_TOO_MANY_REQUESTS, "wait for fewer jobs at a time",
                    "your requests wait for %zu jobs; at most %d are accepted per user, %d in all",
                    ids, (int)USER_IDS, (int)ALL_IDS);
    server_reply_error(s->server, to, &error);
}

void method_wait(service *s, const server_request *r) {
    const sheard_msg_wait *p = &r->request->params.wait;
    pending_waits *all = s->waits;
    assert(p->n_ids > 0);
    wait_user *u = find_user(all, r->peer->uid);
    if (u == NULL) {
        refuse_memory(s, r->handle);
        return;
    }
    if (u->ids > 0 && (u->ids + p->n_ids > USER_IDS || all->ids + p->n_ids > ALL_IDS)) {
        refuse_many(s, r->handle, u->ids);
        return;
    }
    pending_wait *w = wait_new(s, p->n_ids, p->timeout_s);
    if (w == NULL) {
        remove_ids(all, u, 0);
        refuse_memory(s, r->handle);
        return;
    }
    add_ids(all, u, w->n_ids);
    w->user = u;
    w->ids = p->ids;
    listing_begin(&w->list, s, r, wait_step, wait_drop);
}

void pending_waits_add_submitted(service *s, server_handle to, bool known, int64_t id) {
    pending_wait *w = wait_new(s, 1, NAN);
    if (w == NULL) {
        refuse_memory(s, to);
        return;
    }
    const server_work work = {.step = wait_step, .drop = wait_drop, .context = w};
    w->list = (listing){.s = s, .to = to};
    w->submit = true;
    w->known = known;
    w->one = id;
    w->ids = &w->one;
    server_defer(s->server, to, &work);
}

/* ---- wake up ---- */

static bool waits_for(const pending_wait *w, int64_t id) {
    return id >= w->pending[0] && id <= w->pending[w->n_pending - 1] &&
           bsearch(&id, w->pending, w->n_pending, sizeof id, ascending) != NULL;
}

/* Wake the waits whose last job has ended. They read the states again, since a job that had failed
 * may have been retried. */
void pending_waits_job_ended(service *s, int64_t id) {
    pending_wait *next;
    for (pending_wait *w = TAILQ_FIRST(&s->waits->asleep); w != NULL; w = next) {
        next = TAILQ_NEXT(w, link);
        if (!waits_for(w, id))
            continue;
        if (w->left > 0)
            w->left--;
        if (w->left == 0)
            wake_up(w);
    }
}

void pending_waits_tick(service *s) {
    pending_wait *next;
    for (pending_wait *w = TAILQ_FIRST(&s->waits->asleep); w != NULL; w = next) {
        next = TAILQ_NEXT(w, link);
        if (is_over(w))
            wake_up(w);
    }
}

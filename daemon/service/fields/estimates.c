/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/estimates.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/parts.h"

#include <assert.h>
#include <math.h>

void estimates_init(estimates *all) {
    estimate_cache_init(&all->cache);
    TAILQ_INIT(&all->queue);
    TAILQ_INIT(&all->pending);
}

void estimates_note_retraction(service *s) {
    s->estimates->retractions++;
}

/* Return how often contributions may have been lost: by failed commits and retractions. */
static int64_t losses(const service *s) {
    return s->group.failed_commits + s->estimates->retractions;
}

/* Return true if the cached result is good for a request with this `since`. */
static bool is_good(const service *s, const estimate *e, const store_field *f, int64_t since) {
    if (e->number > since)
        return true;
    return e->number > 0 && e->solution.code == SHEAR_OK && e->solution.jobs == f->jobs &&
           e->solution.losses == losses(s);
}

/* Remove the oldest cache entries that no pending request needs. */
static void shrink(estimates *all) {
    int64_t needed = INT64_MAX;
    const pending_request *r;
    TAILQ_FOREACH(r, &all->pending, link) {
        needed = r->first < needed ? r->first : needed;
    }
    estimate_cache_shrink(&all->cache, needed);
}

/* ---- solving ---- */

/* Solve, in a thread of the pool, which alone uses the record meanwhile. */
static void solve(uv_work_t *work) {
    solving *t = work->data;
    shear_error ignored;
    if (t->found.code == SHEAR_OK) {
        t->found.code = shear_estimate(t->estimator, t->sums, t->terms, &t->found.result, &ignored);
    }
}

/* Load what the store has of the field now. */
static int load(service *s, solving *t, shear_error *err) {
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    const estimate *e = t->what;
    TRY(store_field_get(s->store, e->name, &page, err));
    const store_field *f = store_field_page_find(&page, e->digest);
    if (f == NULL)
        return shear_fail(err, STORE_NOT_FOUND, NULL, "field '%s' is gone", e->name);
    t->found.jobs = f->jobs;
    TRY(shear_field_sums_parse(&t->sums, f->sums, err));
    TRY(shear_symmetry_new(&t->terms, err));
    return store_field_terms(s->store, e->name, e->digest, t->terms, err);
}

/* Wake the requests that waited for this result and for no other. When the service closes, they are
 * dropped soon anyway. */
static void wake_pending(service *s, const estimate *e) {
    const bool closing = s->server == NULL || s->life.closing;
    pending_request *r;
    TAILQ_FOREACH(r, &s->estimates->pending, link) {
        for (size_t i = 0; i < r->n; i++) {
            if (r->waits_for[i] == e) {
                r->waits_for[i] = NULL;
                r->left--;
                if (r->left == 0 && !closing)
                    server_wake(s->server, r->to);
            }
        }
    }
}

static void solve_next(service *s);

static void solved(uv_work_t *work, int status) {
    solving *t = work->data;
    service *s = t->s;
    estimate *e = t->what;
    (void)status; /* never cancelled */
    assert(e != NULL && e->state == ESTIMATE_SOLVING);
    e->state = ESTIMATE_IDLE;
    e->pending = 0;
    e->for_notices = false;
    e->number = s->estimates->begun; /* solvings run one at a time */
    e->solution = t->found;
    shear_field_sums_free(t->sums);
    shear_symmetry_free(t->terms);
    t->what = NULL;
    wake_pending(s, e);
    shrink(s->estimates);
    solve_next(s);
}

/* Start solving the next field of the queue, unless one is under way. */
static void solve_next(service *s) {
    estimates *all = s->estimates;
    solving *t = &all->solving;
    estimate *e = TAILQ_FIRST(&all->queue);
    shear_error err = {0};
    if (t->what != NULL || e == NULL || s->server == NULL || s->life.closing)
        return;
    assert(e->state == ESTIMATE_QUEUED);
    TAILQ_REMOVE(&all->queue, e, queue);
    e->state = ESTIMATE_SOLVING;
    all->begun++;
    *t = (solving){.s = s, .what = e, .estimator = e->estimator, .found.losses = losses(s)};
    t->work.data = t;
    t->found.code = load(s, t, &err);
    if (t->found.code != SHEAR_OK)
        log_warning("field '%s' cannot be solved: %s", e->name, err.message);
    uv_queue_work(&s->loop, &t->work, solve, solved);
}

/* ---- requests ---- */

static enum shear_estimator estimator_of(const store_field *f) {
    shear_settings settings;
    return sheard_settings_read(&settings, f->settings, NULL) == SHEAR_OK ? settings.estimator
                                                                          : SHEAR_ESTIMATOR_MEAN;
}

/* Request a result. *out is the entry that is queued or being solved for it, or NULL if the result
 * is available. One that is being solved may have been loaded before its last job was counted; the
 * request is then repeated. False: out of memory. */
static bool want(service *s, const store_field *f, int64_t since, estimate **out) {
    estimates *all = s->estimates;
    const enum shear_estimator estimator = estimator_of(f);
    *out = NULL;
    if (f->jobs == 0 || !shear_estimator_is_symmetric(estimator))
        return true;
    estimate *e = estimate_cache_request(&all->cache, f);
    if (e == NULL)
        return false;
    if (is_good(s, e, f, since))
        return true;
    if (e->state == ESTIMATE_IDLE) {
        e->state = ESTIMATE_QUEUED;
        e->estimator = estimator;
        TAILQ_INSERT_TAIL(&all->queue, e, queue);
    }
    *out = e;
    return true;
}

bool estimates_at_hand(service *s, const store_field *f, int64_t since) {
    estimate *e = NULL;
    const bool there = !want(s, f, since, &e) || e == NULL;
    if (e != NULL)
        e->for_notices = true;
    solve_next(s);
    return there;
}

/* List the request, with memory to wait for n fields. False: out of memory. */
static bool note_pending(estimates *all, pending_request *r, size_t n) {
    assert(r->left == 0);
    if (!r->listed) {
        r->listed = true;
        r->first = all->cache.requests;
        TAILQ_INSERT_TAIL(&all->pending, r, link);
    }
    estimate **larger = realloc(r->waits_for, (n + 1) * sizeof(estimate *));
    if (larger == NULL)
        return false;
    r->waits_for = larger;
    r->n = 0;
    return true;
}

static bool wait_for(service *s, pending_request *r, const store_field *f, int64_t since) {
    estimate *e;
    if (!want(s, f, since, &e))
        return false;
    if (e != NULL) {
        e->pending++;
        r->waits_for[r->n++] = e;
        r->left++;
    }
    return true;
}

int estimates_request(service *s, pending_request *r, const store_field_page *page,
                      const char *digest, int64_t since, sheard_rpc_error *error) {
    bool good = note_pending(s->estimates, r, page->n);
    for (size_t i = 0; good && i < page->n; i++) {
        const store_field *f = &page->fields[i];
        if (digest == NULL || strcmp(digest, f->settings_digest) == 0)
            good = wait_for(s, r, f, since);
    }
    if (!good) {
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                               "out of memory for solving a field");
    }
    solve_next(s);
    return r->left == 0 ? SHEARD_RPC_OK : ESTIMATES_PENDING;
}

int estimates_get(service *s, const store_field *f, const shear_field_sums *sums, int64_t since,
                  shear_result *out, int64_t *jobs, shear_error *err) {
    const estimate *e = estimate_cache_find(&s->estimates->cache, f);
    /* Nothing was counted, or the result was not requested. */
    if (e == NULL || !is_good(s, e, f, since)) {
        shear_field_result(sums, out);
        out->estimator = estimator_of(f);
        out->valid = false;
        out->g1 = out->g2 = out->g1_err = out->g2_err = out->cov12 = NAN;
        return SHEAR_OK;
    }
    *jobs = e->solution.jobs;
    *out = e->solution.result;
    return e->solution.code == SHEAR_OK
               ? SHEAR_OK
               : shear_fail(err, e->solution.code, "ask again; the log says why",
                            "field '%s' could not be solved", f->name);
}

/* One request less waits for this result: remove it from the queue if it was the last. */
static void give_up(estimates *all, estimate *e) {
    assert(e->pending > 0);
    e->pending--;
    if (e->pending == 0 && !e->for_notices && e->state == ESTIMATE_QUEUED) {
        TAILQ_REMOVE(&all->queue, e, queue);
        e->state = ESTIMATE_IDLE;
    }
}

void estimates_forget(service *s, pending_request *r) {
    estimates *all = s->estimates;
    if (!r->listed)
        return;
    r->listed = false;
    TAILQ_REMOVE(&all->pending, r, link);
    for (size_t i = 0; i < r->n; i++) {
        if (r->waits_for[i] != NULL)
            give_up(all, r->waits_for[i]);
    }
    free(r->waits_for);
    shrink(all);
}

void estimates_deinit(estimates *all) {
    assert(TAILQ_EMPTY(&all->pending)); /* the server has dropped all requests */
    estimate_cache_deinit(&all->cache);
}

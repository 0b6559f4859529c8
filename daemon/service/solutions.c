/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of fields whose estimator is a symmetric one. They are made of the terms of all their
 * stamps, so they are solved when somebody asks, one after the other, on a thread of libuv's pool:
 * the loop only reads the terms. Requests wait for theirs; the results of the fields that were
 * asked for last are kept until another job is counted. An entry takes less than 1 KiB; solving
 * takes 76 bytes a stamp for its time. */
#include "service/methods.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* More than the rows of one reply, so that a request finds all that was solved for it. */
enum { MOST = SHEAR_MSG_FIELDS_PAGE + 24 };

typedef struct solution {
    char *name, *digest;
    int64_t jobs;           /* that were counted: contributions come, and never go ... */
    int64_t failed_commits; /* ... unless the commit fails that brought them */
    int64_t number;         /* of its solving, from 1 */
    int64_t asked;          /* when, in askings */
    int code;               /* not SHEAR_OK: why there is no result */
    shear_error err;
    shear_result result;
} solution;

/* A field that is to be solved. */
typedef struct wanted {
    struct wanted *next;
    char *name, *digest;
    int estimator;
    int64_t number; /* grows along the queue */
} wanted;

/* A request that waits. */
typedef struct asked {
    struct asked *next;
    server_handle to;
    shear_request request;
    int64_t since; /* solvings that had begun when it came: later ones are good enough for it */
    int64_t until; /* the last field that it wants */
} asked;

/* The solving that is under way. */
typedef struct task {
    uv_work_t work; /* its data: the service */
    wanted *what;   /* NULL: none is */
    shear_field_sums *sums;
    shear_symmetry *terms;
    solution found;
} task;

struct solutions {
    solution of[MOST];
    size_t n;
    int64_t askings;
    wanted *first, **last;
    int64_t n_wanted, n_begun;
    task task;
    asked *waiting;
    int64_t since; /* see solutions_since */
};

int solutions_new(solutions **all, shear_error *err) {
    *all = calloc(1, sizeof **all);
    if (*all == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for fields' results");
    }
    (*all)->last = &(*all)->first;
    (*all)->since = INT64_MAX;
    return SHEAR_OK;
}

static void wanted_free(wanted *w) {
    if (w != NULL) {
        free(w->name);
        free(w->digest);
        free(w);
    }
}

static void asked_free(asked *a) {
    shear_request_deinit(&a->request);
    free(a);
}

static void forget(solution *one) {
    free(one->name);
    free(one->digest);
    *one = (solution){0};
}

void solutions_free(solutions *all) {
    for (size_t i = 0; all != NULL && i < all->n; i++) {
        forget(&all->of[i]);
    }
    while (all != NULL && all->first != NULL) {
        wanted *w = all->first;
        all->first = w->next;
        wanted_free(w);
    }
    while (all != NULL && all->waiting != NULL) {
        asked *a = all->waiting;
        all->waiting = a->next;
        asked_free(a);
    }
    free(all);
}

/* ---- what is kept ---- */

static solution *find(solutions *all, const char *name, const char *digest) {
    for (size_t i = 0; i < all->n; i++) {
        if (strcmp(all->of[i].name, name) == 0 && strcmp(all->of[i].digest, digest) == 0) {
            return &all->of[i];
        }
    }
    return NULL;
}

/* Room for one more: a new entry, or the one that was asked for longest ago. */
static solution *room(solutions *all) {
    if (all->n < MOST) {
        return &all->of[all->n++];
    }
    solution *oldest = &all->of[0];
    for (size_t i = 1; i < all->n; i++) {
        oldest = all->of[i].asked < oldest->asked ? &all->of[i] : oldest;
    }
    forget(oldest);
    return oldest;
}

/* The names become the entry's. */
static void keep(solutions *all, const solution *found) {
    solution *one = find(all, found->name, found->digest);
    if (one != NULL) {
        forget(one);
    } else {
        one = room(all);
    }
    *one = *found;
    one->asked = ++all->askings;
}

static bool is_current(const service *s, const solution *one, const store_field *f) {
    return one->code == SHEAR_OK && one->jobs == f->jobs &&
           one->failed_commits == s->failed_commits;
}

static solution *good_enough(service *s, const store_field *f) {
    solution *one = find(s->solutions, f->name, f->settings_digest);
    const bool fresh = one != NULL && one->number > s->solutions->since;
    return one != NULL && (fresh || is_current(s, one, f)) ? one : NULL;
}

int64_t solutions_begun(const service *s) {
    return s->solutions->n_begun;
}

void solutions_since(service *s, int64_t begun) {
    s->solutions->since = begun;
}

/* ---- solving ---- */

/* On a thread of the pool, which alone touches the task meanwhile. */
static void solve(uv_work_t *work) {
    task *t = (task *)((char *)work - offsetof(task, work));
    solution *found = &t->found;
    if (found->code == SHEAR_OK) {
        found->code =
            shear_estimate(t->what->estimator, t->sums, t->terms, &found->result, &found->err);
    }
}

/* What the store has of the field now. */
static int take_up(service *s, task *t, shear_error *err) {
    store_field_page page = {0};
    const wanted *w = t->what;
    int code = store_field_get(s->store, w->name, &page, err);
    for (size_t i = 0; code == SHEAR_OK && i < page.n; i++) {
        if (strcmp(page.fields[i].settings_digest, w->digest) == 0) {
            t->found.jobs = page.fields[i].jobs;
            code = shear_field_sums_parse(&t->sums, page.fields[i].sums, err);
        }
    }
    store_field_page_deinit(&page);
    if (code == SHEAR_OK && t->sums == NULL) {
        code = shear_fail(err, STORE_NOT_FOUND, NULL, "field '%s' is gone", w->name);
    }
    if (code == SHEAR_OK) {
        code = shear_symmetry_new(&t->terms, err);
    }
    return code == SHEAR_OK ? store_field_terms(s->store, w->name, w->digest, t->terms, err) : code;
}

static void solved(uv_work_t *work, int status);

/* The next field of the queue to the pool. */
static void begin_next(service *s) {
    solutions *all = s->solutions;
    task *t = &all->task;
    if (t->what != NULL || all->first == NULL || s->closing) {
        return;
    }
    wanted *w = all->first;
    all->first = w->next;
    all->last = all->first != NULL ? all->last : &all->first;
    *t = (task){.work.data = s,
                .what = w,
                .found = {.number = ++all->n_begun, .failed_commits = s->failed_commits}};
    t->found.code = take_up(s, t, &t->found.err);
    uv_queue_work(&s->loop, &t->work, solve, solved);
}

/* The requests that have waited for fields up to `number`, in the order in which they came. */
static void run_again(service *s, int64_t number) {
    solutions *all = s->solutions;
    asked *ready = NULL;
    for (asked **at = &all->waiting; *at != NULL;) {
        asked *a = *at;
        if (a->until <= number) {
            *at = a->next;
            a->next = ready; /* the newest came first */
            ready = a;
        } else {
            at = &a->next;
        }
    }
    while (ready != NULL) {
        asked *a = ready;
        ready = a->next;
        const server_request request = {.handle = a->to, .request = &a->request};
        solutions_since(s, a->since);
        methods_request(s, &request);
        solutions_since(s, INT64_MAX);
        asked_free(a);
    }
}

static void solved(uv_work_t *work, int status) {
    service *s = work->data;
    task *t = &s->solutions->task;
    wanted *w = t->what;
    const int64_t number = w->number;
    (void)status; /* never cancelled */
    t->found.name = w->name;
    t->found.digest = w->digest;
    w->name = w->digest = NULL; /* handed over */
    keep(s->solutions, &t->found);
    wanted_free(w);
    shear_field_sums_free(t->sums);
    shear_symmetry_free(t->terms);
    t->what = NULL;
    if (s->server != NULL && !s->closing) {
        run_again(s, number);
        begin_next(s);
    }
}

/* ---- requests ---- */

static int estimator_of(const store_field *f) {
    shear_settings settings;
    shear_settings_init(&settings);
    return shear_settings_apply(&settings, f->settings, NULL) == SHEAR_OK ? settings.estimator
                                                                          : SHEAR_ESTIMATOR_MEAN;
}

/* Number of the field in the queue: where it waits already, or at the end; 0: out of memory. */
static int64_t enqueue(solutions *all, const store_field *f, int estimator) {
    for (wanted *w = all->first; w != NULL; w = w->next) {
        if (strcmp(w->name, f->name) == 0 && strcmp(w->digest, f->settings_digest) == 0) {
            return w->number;
        }
    }
    wanted *w = calloc(1, sizeof *w);
    if (w == NULL) {
        return 0;
    }
    *w = (wanted){.name = strdup(f->name),
                  .digest = strdup(f->settings_digest),
                  .estimator = estimator,
                  .number = all->n_wanted + 1};
    if (w->name == NULL || w->digest == NULL) {
        wanted_free(w);
        return 0;
    }
    *all->last = w;
    all->last = &w->next;
    return ++all->n_wanted;
}

/* 0: its result is at hand; else its number in the queue; -1: out of memory. */
static int64_t want(service *s, const store_field *f) {
    const int estimator = estimator_of(f);
    if (f->jobs == 0 || !shear_estimator_is_symmetric(estimator) || good_enough(s, f) != NULL) {
        return 0;
    }
    const int64_t number = enqueue(s->solutions, f, estimator);
    return number > 0 ? number : -1;
}

bool solutions_at_hand(service *s, const store_field *f) {
    const int64_t number = want(s, f);
    begin_next(s);
    return number <= 0;
}

static void refuse(service *s, server_handle to) {
    method_refuse(s, to, SHEAR_RPC_OUT_OF_MEMORY, "out of memory for solving a field");
}

bool solutions_ready(service *s, const server_request *r, const store_field_page *page) {
    solutions *all = s->solutions;
    int64_t until = 0;
    for (size_t i = 0; i < page->n; i++) {
        const int64_t number = want(s, &page->fields[i]);
        if (number < 0) {
            refuse(s, r->handle);
            return false;
        }
        until = number > until ? number : until;
    }
    if (until == 0) {
        return true;
    }
    asked *a = calloc(1, sizeof *a);
    if (a == NULL) {
        refuse(s, r->handle);
        return false;
    }
    *a = (asked){.next = all->waiting,
                 .to = r->handle,
                 .request = *r->request,
                 .since = all->since < all->n_begun ? all->since : all->n_begun,
                 .until = until};
    *r->request = (shear_request){0}; /* taken over */
    all->waiting = a;
    begin_next(s);
    return false;
}

int solutions_get(service *s, const store_field *f, const shear_field_sums *sums, shear_result *out,
                  int64_t *jobs, shear_error *err) {
    solution *one = good_enough(s, f);
    if (one == NULL) { /* nothing was counted, or nobody waited */
        shear_field_result(sums, out);
        out->estimator = estimator_of(f);
        out->valid = false;
        out->g1 = out->g2 = out->g1_err = out->g2_err = out->cov12 = NAN;
        return SHEAR_OK;
    }
    one->asked = ++s->solutions->askings;
    *jobs = one->jobs;
    *out = one->result;
    if (one->code != SHEAR_OK && err != NULL) {
        *err = one->err;
    }
    return one->code;
}

void solutions_forget(service *s, uint64_t connection) {
    for (asked **at = &s->solutions->waiting; *at != NULL;) {
        asked *a = *at;
        if (a->to.connection == connection) {
            *at = a->next;
            asked_free(a);
        } else {
            at = &a->next;
        }
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of fields whose estimator is a symmetric one. They are made of the terms of all their
 * stamps, so they are solved when somebody asks, one after the other, on a thread of libuv's pool:
 * the loop only reads the terms. Requests wait for theirs. Results are kept until another job is
 * counted: those that a waiting request needs, and else of the fields that were asked for last. A
 * result takes less than 1 KiB; solving takes 76 bytes a stamp for its time. */
#include "service/rpc/methods.h"

#include <math.h>
#include <search.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { KEPT = 1024 };

/* What is known of a field. */
typedef struct solution {
    char *name, *digest;
    enum shear_estimator estimator;
    struct solution *older, *newer; /* by when somebody asked for it last */
    int64_t asked;                  /* ... in askings */
    struct solution *next;          /* in the queue */
    int64_t wanted;                 /* its number there; 0: it does not wait */
    size_t wanters;                 /* requests that wait for it */
    bool for_news;                  /* news wait for it too */
    bool begun;                     /* it is being solved */
    int64_t number;                 /* of the solving that made what follows, from 1; 0: nothing */
    int64_t jobs;                   /* that were counted: contributions come, and never go ... */
    int64_t losses;                 /* ... but with one of these */
    int code;                       /* not SHEAR_OK: why there is no result */
    shear_result result;
} solution;

/* A request that has asked for fields, until it is dropped. */
typedef struct asked {
    struct asked *next;
    server_handle to;
    int64_t first;        /* askings before its own: what was asked for since is kept for it */
    size_t left;          /* of those it waits for, not solved yet */
    solution **waits_for; /* [n] NULL: solved */
    size_t n;
} asked;

/* The solving that is under way. */
typedef struct task {
    uv_work_t work; /* its data: the service */
    solution *what; /* NULL: none is */
    enum shear_estimator estimator;
    shear_field_sums *sums;
    shear_symmetry *terms;
    int code;
    shear_result result;
    int64_t jobs, losses;
} task;

struct solutions {
    void *tree; /* tsearch: of all, by name and digest */
    size_t n;
    solution *oldest, *newest;
    int64_t askings;
    solution *first, **last; /* the queue */
    int64_t n_wanted, n_begun;
    task task;
    asked *asked;  /* the oldest first */
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

/* ---- what is kept ---- */

static int by_names(const void *a, const void *b) {
    const solution *one = a;
    const solution *other = b;
    const int order = strcmp(one->name, other->name);
    return order != 0 ? order : strcmp(one->digest, other->digest);
}

static solution *find(const solutions *all, const store_field *f) {
    const solution like = {.name = f->name, .digest = f->settings_digest};
    solution **found = tfind(&like, &all->tree, by_names);
    return found != NULL ? *found : NULL;
}

static void unlink_age(solutions *all, solution *one) {
    *(one->older != NULL ? &one->older->newer : &all->oldest) = one->newer;
    *(one->newer != NULL ? &one->newer->older : &all->newest) = one->older;
    one->older = one->newer = NULL;
}

static void link_newest(solutions *all, solution *one) {
    one->older = all->newest;
    *(all->newest != NULL ? &all->newest->newer : &all->oldest) = one;
    all->newest = one;
    one->asked = ++all->askings;
}

static void solution_free(solution *one) {
    free(one->name);
    free(one->digest);
    free(one);
}

/* Forget the oldest that nobody needs. */
static void shrink(solutions *all) {
    int64_t needed = INT64_MAX;
    for (const asked *a = all->asked; a != NULL; a = a->next) {
        needed = a->first < needed ? a->first : needed;
    }
    while (all->n > KEPT && all->oldest->wanted == 0 && !all->oldest->begun &&
           all->oldest->asked <= needed) {
        solution *one = all->oldest;
        unlink_age(all, one);
        tdelete(one, &all->tree, by_names);
        all->n--;
        solution_free(one);
    }
}

/* The record of a field that somebody asks for; NULL: out of memory. */
static solution *ask_for(solutions *all, const store_field *f) {
    solution *one = find(all, f);
    if (one != NULL) {
        unlink_age(all, one);
        link_newest(all, one);
        return one;
    }
    one = calloc(1, sizeof *one);
    if (one == NULL) {
        return NULL;
    }
    one->name = strdup(f->name);
    one->digest = strdup(f->settings_digest);
    if (one->name == NULL || one->digest == NULL || tsearch(one, &all->tree, by_names) == NULL) {
        solution_free(one);
        return NULL;
    }
    all->n++;
    link_newest(all, one);
    return one;
}

/* What may have taken contributions away: the commit fails that brought them, or they are
 * retracted.
 */
static int64_t losses(const service *s) {
    return s->failed_commits + s->retractions;
}

/* Has it a result that the request at hand may have? */
static bool is_good(const service *s, const solution *one, const store_field *f) {
    const bool current = one->number > 0 && one->code == SHEAR_OK && one->jobs == f->jobs &&
                         one->losses == losses(s);
    return current || one->number > s->solutions->since;
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
    shear_error ignored;
    if (t->code == SHEAR_OK) {
        t->code = shear_estimate(t->estimator, t->sums, t->terms, &t->result, &ignored);
    }
}

/* What the store has of the field now. */
static int take_up(service *s, task *t, shear_error *err) {
    store_field_page page = {0};
    const solution *one = t->what;
    int code = store_field_get(s->store, one->name, &page, err);
    for (size_t i = 0; code == SHEAR_OK && i < page.n; i++) {
        if (strcmp(page.fields[i].settings_digest, one->digest) == 0) {
            t->jobs = page.fields[i].jobs;
            code = shear_field_sums_parse(&t->sums, page.fields[i].sums, err);
        }
    }
    store_field_page_deinit(&page);
    if (code == SHEAR_OK && t->sums == NULL) {
        return shear_fail(err, STORE_NOT_FOUND, NULL, "field '%s' is gone", one->name);
    }
    code = code == SHEAR_OK ? shear_symmetry_new(&t->terms, err) : code;
    return code == SHEAR_OK ? store_field_terms(s->store, one->name, one->digest, t->terms, err)
                            : code;
}

/* Those that waited for it, and for nothing else, go on. */
static void wake_waiting(service *s, const solution *one) {
    for (asked *a = s->solutions->asked; a != NULL; a = a->next) {
        for (size_t i = 0; i < a->n; i++) {
            if (a->waits_for[i] == one) {
                a->waits_for[i] = NULL;
                if (--a->left == 0) {
                    server_wake(s->server, a->to);
                }
            }
        }
    }
}

static void solved(uv_work_t *work, int status);

/* The next field of the queue to the pool. */
static void begin_next(service *s) {
    solutions *all = s->solutions;
    task *t = &all->task;
    solution *one = all->first;
    shear_error err = {0};
    if (t->what != NULL || one == NULL || s->closing) {
        return;
    }
    all->first = one->next;
    all->last = all->first != NULL ? all->last : &all->first;
    one->next = NULL;
    one->begun = true;
    all->n_begun++;
    *t = (task){.work.data = s, .what = one, .estimator = one->estimator, .losses = losses(s)};
    t->code = take_up(s, t, &err);
    if (t->code != SHEAR_OK) {
        log_warning("field '%s' cannot be solved: %s", one->name, err.message);
    }
    uv_queue_work(&s->loop, &t->work, solve, solved);
}

static void solved(uv_work_t *work, int status) {
    service *s = work->data;
    solutions *all = s->solutions;
    task *t = &all->task;
    solution *one = t->what;
    (void)status; /* never cancelled */
    one->wanted = 0;
    one->wanters = 0;
    one->for_news = false;
    one->begun = false;
    one->number = all->n_begun; /* one at a time */
    one->jobs = t->jobs;
    one->losses = t->losses;
    one->code = t->code;
    one->result = t->result;
    shear_field_sums_free(t->sums);
    shear_symmetry_free(t->terms);
    t->what = NULL;
    if (s->server != NULL && !s->closing) {
        wake_waiting(s, one);
        shrink(all);
        begin_next(s);
    }
}

/* ---- asking ---- */

static enum shear_estimator estimator_of(const store_field *f) {
    shear_settings settings;
    return sheard_settings_read(&settings, f->settings, NULL) == SHEAR_OK ? settings.estimator
                                                                          : SHEAR_ESTIMATOR_MEAN;
}

/* *out: what is in the queue, or being solved, for it; NULL: its result is at hand. One that is
 * being solved may have been taken up before its last job was counted: it is asked for again after
 * that. False: out of memory. */
static bool want(service *s, const store_field *f, solution **out) {
    solutions *all = s->solutions;
    const enum shear_estimator estimator = estimator_of(f);
    *out = NULL;
    if (f->jobs == 0 || !shear_estimator_is_symmetric(estimator)) {
        return true;
    }
    solution *one = ask_for(all, f);
    if (one == NULL) {
        return false;
    }
    if (is_good(s, one, f)) {
        return true;
    }
    if (one->wanted == 0) {
        one->estimator = estimator;
        one->wanted = ++all->n_wanted;
        *all->last = one;
        all->last = &one->next;
    }
    *out = one;
    return true;
}

bool solutions_at_hand(service *s, const store_field *f) {
    solution *one = NULL;
    const bool there = !want(s, f, &one) || one == NULL;
    if (one != NULL) {
        one->for_news = true;
    }
    begin_next(s);
    return there;
}

/* Where the request's record is linked, or would be: behind all others. */
static asked **find_asked(solutions *all, server_handle to) {
    asked **at = &all->asked;
    while (*at != NULL &&
           ((*at)->to.connection != to.connection || (*at)->to.request != to.request)) {
        at = &(*at)->next;
    }
    return at;
}

/* The request's record, with room to wait for n fields; NULL: out of memory. */
static asked *note_asked(solutions *all, server_handle to, int64_t first, size_t n) {
    asked **at = find_asked(all, to);
    if (*at == NULL) {
        *at = calloc(1, sizeof **at);
        if (*at == NULL) {
            return NULL;
        }
        **at = (asked){.to = to, .first = first};
    }
    asked *a = *at;
    solution **room = realloc(a->waits_for, (n + 1) * sizeof(solution *));
    a->waits_for = room != NULL ? room : a->waits_for;
    a->n = a->left = 0;
    return room != NULL ? a : NULL;
}

static bool wait_for(service *s, asked *a, const store_field *f) {
    solution *one;
    if (!want(s, f, &one)) {
        return false;
    }
    if (one != NULL) {
        one->wanters++;
        a->waits_for[a->n++] = one;
        a->left++;
    }
    return true;
}

bool solutions_ready(service *s, server_handle to, const store_field_page *page,
                     const char *digest) {
    solutions *all = s->solutions;
    asked *a = note_asked(all, to, all->askings, page->n);
    bool good = a != NULL;
    for (size_t i = 0; good && i < page->n; i++) {
        const store_field *f = &page->fields[i];
        good = (digest != NULL && strcmp(digest, f->settings_digest) != 0) || wait_for(s, a, f);
    }
    if (!good) {
        method_refuse(s, to, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for solving a field");
        return false;
    }
    begin_next(s);
    return a->left == 0;
}

int solutions_get(service *s, const store_field *f, const shear_field_sums *sums, shear_result *out,
                  int64_t *jobs, shear_error *err) {
    const solution *one = find(s->solutions, f);
    if (one == NULL || !is_good(s, one, f)) { /* nothing was counted, or nobody waited */
        shear_field_result(sums, out);
        out->estimator = estimator_of(f);
        out->valid = false;
        out->g1 = out->g2 = out->g1_err = out->g2_err = out->cov12 = NAN;
        return SHEAR_OK;
    }
    *jobs = one->jobs;
    *out = one->result;
    return one->code == SHEAR_OK ? SHEAR_OK
                                 : shear_fail(err, one->code, "ask again; the log tells why",
                                              "field '%s' could not be solved", f->name);
}

/* Nobody wants it any more: out of the queue. */
static void give_up(solutions *all, solution *one) {
    solution **at = &all->first;
    while (*at != NULL && *at != one) {
        at = &(*at)->next;
    }
    if (*at == one) {
        *at = one->next;
        all->last = one->next == NULL ? at : all->last;
        one->next = NULL;
        one->wanted = 0;
    }
}

static void asked_free(solutions *all, asked *a) {
    for (size_t i = 0; i < a->n; i++) {
        solution *one = a->waits_for[i];
        if (one != NULL && --one->wanters == 0 && !one->for_news && !one->begun) {
            give_up(all, one);
        }
    }
    free(a->waits_for);
    free(a);
}

void solutions_forget(service *s, server_handle to) {
    solutions *all = s->solutions;
    asked **at = find_asked(all, to);
    if (*at != NULL) {
        asked *a = *at;
        *at = a->next;
        asked_free(all, a);
        shrink(all);
    }
}

static void free_node(void *node) {
    solution_free(node);
}

void solutions_free(solutions *all) {
    if (all != NULL) {
        while (all->asked != NULL) {
            asked *a = all->asked;
            all->asked = a->next;
            asked_free(all, a);
        }
        tdestroy(all->tree, free_node);
        free(all);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of fields whose estimator is a symmetric one. They are made of the terms of all their
 * stamps, so they are solved when somebody asks, and kept until another job is counted: of the
 * fields that were asked for last. An entry takes less than 1 KiB; solving takes 76 bytes a stamp
 * for its time.
 */
#include "service/inner.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 1024 };

typedef struct solution {
    char *name, *digest;
    int64_t jobs;           /* that were counted: contributions come, and never go ... */
    int64_t failed_commits; /* ... unless the commit fails that brought them */
    int64_t asked;          /* when, in askings */
    shear_result result;
} solution;

struct solutions {
    solution of[MOST];
    size_t n;
    int64_t askings;
};

int solutions_new(solutions **all, shear_error *err) {
    *all = calloc(1, sizeof **all);
    return *all != NULL ? SHEAR_OK
                        : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for fields' results");
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
    free(all);
}

static solution *find(solutions *all, const store_field *f) {
    for (size_t i = 0; i < all->n; i++) {
        if (strcmp(all->of[i].name, f->name) == 0 &&
            strcmp(all->of[i].digest, f->settings_digest) == 0) {
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

static void keep(service *s, const store_field *f, const shear_result *result) {
    solutions *all = s->solutions;
    solution *one = find(all, f);
    char *name = one == NULL ? strdup(f->name) : NULL;
    char *digest = one == NULL ? strdup(f->settings_digest) : NULL;
    if (one == NULL && (name == NULL || digest == NULL)) {
        free(name);
        free(digest);
        return; /* solved again next time */
    }
    if (one == NULL) {
        one = room(all);
        one->name = name;
        one->digest = digest;
    }
    one->jobs = f->jobs;
    one->failed_commits = s->failed_commits;
    one->result = *result;
    one->asked = ++all->askings;
}

static int solve(service *s, const store_field *f, int estimator, const shear_field_sums *sums,
                 shear_result *out, shear_error *err) {
    shear_symmetry *terms = NULL;
    int code = shear_symmetry_new(&terms, err);
    if (code == SHEAR_OK && f->jobs > 0) {
        code = store_field_terms(s->store, f->name, f->settings_digest, terms, err);
    }
    if (code == SHEAR_OK) {
        code = shear_estimate(estimator, sums, terms, out, err);
    }
    shear_symmetry_free(terms);
    return code;
}

int solutions_get(service *s, const store_field *f, int estimator, const shear_field_sums *sums,
                  shear_result *out, shear_error *err) {
    solution *one = find(s->solutions, f);
    if (one != NULL && one->jobs == f->jobs && one->failed_commits == s->failed_commits) {
        *out = one->result;
        one->asked = ++s->solutions->askings;
        return SHEAR_OK;
    }
    const int code = solve(s, f, estimator, sums, out, err);
    if (code == SHEAR_OK && f->jobs > 0) {
        keep(s, f, out);
    }
    return code;
}

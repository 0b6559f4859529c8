/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/estimate_cache.h"

#include <assert.h>
#include <search.h>
#include <stdlib.h>
#include <string.h>

enum { KEPT = 1024 };

static int by_names(const void *a, const void *b) {
    const estimate *x = a;
    const estimate *y = b;
    const int order = strcmp(x->name, y->name);
    return order != 0 ? order : strcmp(x->digest, y->digest);
}

static void estimate_free(estimate *e) {
    free(e->name);
    free(e->digest);
    free(e);
}

void estimate_cache_init(estimate_cache *c) {
    *c = (estimate_cache){.n = 0};
    TAILQ_INIT(&c->by_age);
}

static void forget(estimate_cache *c, estimate *e) {
    TAILQ_REMOVE(&c->by_age, e, age);
    tdelete(e, &c->tree, by_names);
    c->n--;
    estimate_free(e);
}

void estimate_cache_deinit(estimate_cache *c) {
    for (estimate *e; (e = TAILQ_FIRST(&c->by_age)) != NULL;)
        forget(c, e);
}

estimate *estimate_cache_find(const estimate_cache *c, const store_field *f) {
    const estimate like = {.name = f->name, .digest = f->settings_digest};
    estimate **found = tfind(&like, &c->tree, by_names);
    return found != NULL ? *found : NULL;
}

static estimate *add(estimate_cache *c, const store_field *f) {
    estimate *e = calloc(1, sizeof *e);
    if (e == NULL)
        return NULL;
    e->name = strdup(f->name);
    e->digest = strdup(f->settings_digest);
    if (e->name == NULL || e->digest == NULL || tsearch(e, &c->tree, by_names) == NULL) {
        estimate_free(e);
        return NULL;
    }
    c->n++;
    return e;
}

estimate *estimate_cache_request(estimate_cache *c, const store_field *f) {
    estimate *e = estimate_cache_find(c, f);
    if (e != NULL) {
        TAILQ_REMOVE(&c->by_age, e, age);
    } else {
        e = add(c, f);
    }
    if (e != NULL) {
        TAILQ_INSERT_TAIL(&c->by_age, e, age);
        e->requested = ++c->requests;
    }
    return e;
}

void estimate_cache_shrink(estimate_cache *c, int64_t needed) {
    while (c->n > KEPT) {
        estimate *oldest = TAILQ_FIRST(&c->by_age);
        assert(oldest != NULL);
        if (oldest->state != ESTIMATE_IDLE || oldest->requested > needed)
            return;
        forget(c, oldest);
    }
}

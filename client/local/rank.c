/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/rank.h"

#include "base/cleanup.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

typedef struct ranked_item {
    double value;
    size_t index;
} ranked_item;

static int by_value(const void *a, const void *b) {
    const ranked_item *x = a;
    const ranked_item *y = b;
    return (x->value > y->value) - (x->value < y->value);
}

/* Set rank[] to twice the rank of each value, relative to the middle: -n+1 .. n-1. */
static void set_ranks(const double *value, size_t n, ranked_item *items, int64_t *rank) {
    for (size_t i = 0; i < n; i++)
        items[i] = (ranked_item){value[i], i};
    qsort(items, n, sizeof *items, by_value);
    for (size_t first = 0, end; first < n; first = end) {
        for (end = first + 1; end < n && !(items[end].value > items[first].value);)
            end++;
        for (size_t i = first; i < end; i++)
            rank[items[i].index] = (int64_t)(first + end) - (int64_t)n;
    }
}

static double correlate(const int64_t *x, const int64_t *y, size_t n) {
    int64_t xx = 0;
    int64_t yy = 0;
    int64_t xy = 0;
    for (size_t i = 0; i < n; i++) {
        xx += x[i] * x[i];
        yy += y[i] * y[i];
        xy += x[i] * y[i];
    }
    return xx > 0 && yy > 0 ? (double)xy / (sqrt((double)xx) * sqrt((double)yy)) : (double)NAN;
}

rank_relation rank_relate(const double *x, const double *y, size_t n) {
    rank_relation r = {.correlation = NAN, .n = n};
    CLEANUP(release_free) ranked_item *items = malloc((n + 1) * sizeof *items);
    CLEANUP(release_free) int64_t *ranks = malloc((2 * n + 1) * sizeof *ranks);
    assert(n <= RANK_MAX);
    if (items != NULL && ranks != NULL) {
        set_ranks(x, n, items, ranks);
        set_ranks(y, n, items, ranks + n);
        r.correlation = correlate(ranks, ranks + n, n);
    }
    return r;
}

bool rank_is_strong(const rank_relation *r) {
    static const double strong = 0.5;
    static const double sigmas = 5.0;
    return r->n > 1 && fabs(r->correlation) > strong &&
           fabs(r->correlation) * sqrt((double)r->n - 1.0) > sigmas;
}

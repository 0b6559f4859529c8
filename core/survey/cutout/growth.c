/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/growth.h"

#include "base/simd.h"
#include "survey/cutout/marks.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

static size_t width_of(const growth *g) {
    return (size_t)g->n + (size_t)(2 * GROWTH_MOST);
}

void growth_place(growth *g, int n, arena *a) {
    g->n = n;
    for (int w = 0; w <= GROWTH_MOST; w++)
        g->reach[w] = arena_take(a, width_of(g));
}

void growth_begin(growth *g) {
    for (int w = 0; w <= GROWTH_MOST; w++)
        memset(g->reach[w], 0, width_of(g));
}

void growth_add(growth *g, const uint8_t *row, int d, int radius) {
    assert(radius <= GROWTH_MOST);
    if (d > radius)
        return;
    int w = 0;
    while ((w + 1) * (w + 1) + d * d <= radius * radius)
        w++;
    marks_add(g->reach[w], row, width_of(g));
}

/* Return the union of the marks within w pixels of row[GROWTH_MOST]. */
static SHEAR_INLINE uint8_t within(const uint8_t *row, int w) {
    uint8_t any = row[GROWTH_MOST];
    for (int d = 1; d <= w; d++)
        any |= row[GROWTH_MOST - d] | row[GROWTH_MOST + d];
    return any;
}

SHEAR_SIMD void growth_finish(const growth *g, uint8_t *restrict out) {
    const uint8_t *const r0 = g->reach[0];
    const uint8_t *const r1 = g->reach[1];
    const uint8_t *const r2 = g->reach[2];
    const uint8_t *const r3 = g->reach[3];
    const uint8_t *const r4 = g->reach[GROWTH_MOST];
    const int n = g->n;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        out[i] = within(r0 + i, 0) | within(r1 + i, 1) | within(r2 + i, 2) | within(r3 + i, 3) |
                 within(r4 + i, GROWTH_MOST);
    }
}

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

SHEAR_SIMD static void widen(uint8_t *restrict out, const uint8_t *row, size_t w, size_t n) {
    const uint8_t *left = row + GROWTH_MOST - w;
    const uint8_t *right = row + GROWTH_MOST + w;
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        out[i] |= left[i] | right[i];
}

void growth_finish(growth *g, uint8_t *out) {
    /* What is widened by w is also widened by everything less. */
    for (int w = GROWTH_MOST; w > 0; w--)
        marks_add(g->reach[w - 1], g->reach[w], width_of(g));
    memcpy(out, g->reach[0] + GROWTH_MOST, (size_t)g->n);
    for (int w = 1; w <= GROWTH_MOST; w++)
        widen(out, g->reach[w], (size_t)w, (size_t)g->n);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/light.h"

#include "base/simd.h"
#include "shear/stamp.h"
#include "survey/cutout/marks.h"
#include "survey/pixels/chip_pixels.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* The light of another object beyond its isophote. */
static const double psf_radii_beyond = 2.0;

static int wide(const light *l) {
    return l->side + 2 * LIGHT_GROW;
}

static size_t marks_stride(const light *l) {
    return (size_t)l->side + (size_t)(2 * GROWTH_MOST);
}

void light_place(light *l, int side, int frame, arena *a) {
    const size_t n = (size_t)side * (size_t)side;
    l->side = side;
    l->frame = frame;
    l->mask = arena_take(a, n);
    l->away = arena_take(a, n);
    l->own = arena_take(a, n);
    l->marks = arena_take(a, marks_stride(l) * (size_t)wide(l));
    growth_place(&l->grown, side, a);
}

/* The galaxy that is looked at. */
typedef struct place {
    double x, y; /* in pixels of `owner`'s array */
    double r, r_near;
    int32_t owner; /* 0: none of the pixels is its own */
} place;

/* Return the largest distance of its own pixels, 0 if there are none. */
static double extent(const light *l, const place *g) {
    const int n = wide(l);
    double most = 0.0;
    for (int i = 0; g->owner != 0 && i < n * n; i++) {
        if (l->owner[i] == g->owner) {
            const double d = hypot(i % n - g->x, (double)(i / n) - g->y);
            most = d > most ? d : most;
        }
    }
    return most;
}

/* Columns first .. end-1. */
typedef struct columns {
    int first, end;
} columns;

/* Return the columns 0 .. n-1 within r of column x, at a distance dy from it. */
static columns chord(double x, double dy, double r, int n) {
    if (fabs(dy) > r)
        return (columns){0, 0};
    const double half = sqrt((r - dy) * (r + dy));
    const double first = fmax(ceil(x - half), 0.0);
    const double last = fmin(floor(x + half), n - 1.0);
    return first <= last ? (columns){(int)first, (int)last + 1} : (columns){0, 0};
}

SHEAR_SIMD static void mark_others(uint8_t *restrict marks, const int32_t *restrict owner, int n,
                                   int32_t own) {
#pragma omp simd
    for (int i = 0; i < n; i++)
        marks[i] = (uint8_t)((owner[i] != 0) & (owner[i] != own));
}

SHEAR_SIMD static void mark_own(uint8_t *restrict marks, const int32_t *restrict owner, int n,
                                int32_t own) {
#pragma omp simd
    for (int i = 0; i < n; i++)
        marks[i] = (uint8_t)((owner[i] != 0) & (owner[i] == own));
}

static bool any(const uint8_t *marks, columns c) {
    return memchr(marks + c.first, 1, (size_t)(c.end - c.first)) != NULL;
}

/* Mark the pixels of others. Return the rows that have some, and whether some are near. */
static columns find_others(light *l, const place *g, bool *near) {
    const int n = wide(l);
    columns rows = {n, 0};
    *near = false;
    for (int y = 0; y < n; y++) {
        uint8_t *marks = l->marks + (size_t)y * marks_stride(l) + (GROWTH_MOST - LIGHT_GROW);
        mark_others(marks, l->owner + (ptrdiff_t)y * n, n, g->owner);
        if (any(marks, (columns){0, n})) {
            *near = *near || any(marks, chord(g->x, y - g->y, g->r_near, n));
            rows.first = y < rows.first ? y : rows.first;
            rows.end = y + 1;
        }
    }
    return rows;
}

/* Begin the mask with what others have, grown; only these rows have any. */
static void grow_others(light *l, columns rows) {
    for (int y = 0; y < l->side; y++) {
        uint8_t *mask = l->mask + (ptrdiff_t)y * l->side;
        if (y + 2 * LIGHT_GROW < rows.first || y >= rows.end) {
            memset(mask, 0, (size_t)l->side);
            continue;
        }
        growth_begin(&l->grown);
        for (int dy = -LIGHT_GROW; dy <= LIGHT_GROW; dy++) {
            growth_add(&l->grown, l->marks + (size_t)(y + dy + LIGHT_GROW) * marks_stride(l),
                       dy < 0 ? -dy : dy, LIGHT_GROW);
        }
        growth_finish(&l->grown, mask);
    }
}

/* Return what n pixels of light have: bit 0 defects, bit 1 saturated pixels, bit 2 others. */
SHEAR_SIMD static unsigned look_at(const uint8_t *restrict own, const uint8_t *restrict defect,
                                   const uint8_t *restrict other, int n) {
    uint8_t found = 0;
#pragma omp simd reduction(| : found)
    for (int x = 0; x < n; x++) {
        const uint8_t saturated = (defect[x] & PIXEL_SATURATED) != 0;
        const uint8_t hole = (defect[x] != 0) & (saturated ^ 1);
        found |= (uint8_t)(own[x] * (hole + 2 * saturated + 4 * other[x]));
    }
    return found;
}

/* Finish the masks. Return the flags of what is found in its light, in the stamp. */
static uint32_t find_all(light *l, const place *g) {
    const int n = l->side;
    const int stamp = n - 2 * l->frame;
    unsigned found = 0;
    for (int y = 0; y < n; y++) {
        const ptrdiff_t at = (ptrdiff_t)y * n;
        const columns reach = chord(g->x - LIGHT_GROW, y + LIGHT_GROW - g->y, g->r, n);
        const ptrdiff_t wider = (ptrdiff_t)(y + LIGHT_GROW) * wide(l) + LIGHT_GROW;
        mark_own(l->away + at, l->owner + wider, n, g->owner);
        memcpy(l->own + at, l->away + at, (size_t)n);
        memset(l->own + at + reach.first, 1, (size_t)(reach.end - reach.first));
        if (y >= l->frame && y < n - l->frame) {
            const ptrdiff_t in = at + l->frame;
            found |= look_at(l->own + in, l->defect + in, l->mask + in, stamp);
        }
        marks_add(l->mask + at, l->defect + at, (size_t)n);
        marks_add(l->away + at, l->mask + at, (size_t)n);
    }
    return ((found & 1U) != 0 ? SHEAR_FLAG_HOLE : 0U) |
           ((found & 2U) != 0 ? SHEAR_FLAG_SATURATED : 0U) |
           ((found & 4U) != 0 ? SHEAR_FLAG_NEIGHBOUR : 0U);
}

uint32_t light_find(light *l, double x, double y, double r_gal, int32_t owner) {
    const ptrdiff_t middle = l->side / 2 + LIGHT_GROW;
    place g = {.x = x + LIGHT_GROW, .y = y + LIGHT_GROW, .owner = owner};
    if (g.owner == 0)
        g.owner = l->owner[middle * wide(l) + middle];
    g.r = LIGHT_PSF_RADII * l->r_psf_px;
    g.r = r_gal > 0.0 ? g.r + r_gal : fmax(g.r, extent(l, &g));
    g.r_near = g.r + fmax(LIGHT_GROW, psf_radii_beyond * l->r_psf_px);
    bool near;
    const columns rows = find_others(l, &g, &near);
    grow_others(l, rows);
    return find_all(l, &g) | (near ? SHEAR_FLAG_NEIGHBOUR : 0U);
}

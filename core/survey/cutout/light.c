/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/light.h"

#include "base/simd.h"
#include "shear/stamp.h"
#include "survey/pixels/chip_pixels.h"

#include <math.h>
#include <stddef.h>

/* Half of a mock galaxy's light is within 0.5 to 0.7 R_G, and all of it within R_G + 2.6 R_PSF. */
static const double psf_radii = 2.6;
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

/* Mark the pixels of others in a row; return how many are within `reach` of column x. */
SHEAR_SIMD static int mark_others(uint8_t *restrict marks, const int32_t *restrict owner, int n,
                                  int32_t own, double x, double reach) {
    int near = 0;
#pragma omp simd reduction(+ : near)
    for (int i = 0; i < n; i++) {
        const int other = owner[i] != 0 && owner[i] != own;
        marks[i] = (uint8_t)other;
        near += other && fabs(i - x) <= reach;
    }
    return near;
}

/* Return half the length of a row's part within r of the galaxy, whose distance is dy; negative:
 * there is none. */
static double half_chord(double r, double dy) {
    return fabs(dy) <= r ? sqrt((r - dy) * (r + dy)) : -1.0;
}

static bool find_others(light *l, const place *g) {
    const int n = wide(l);
    int near = 0;
    for (int y = 0; y < n; y++) {
        uint8_t *marks = l->marks + (size_t)y * marks_stride(l) + (GROWTH_MOST - LIGHT_GROW);
        near += mark_others(marks, l->owner + (ptrdiff_t)y * n, n, g->owner, g->x,
                            half_chord(g->r_near, y - g->y));
    }
    return near > 0;
}

static void grow_others(light *l) {
    for (int y = 0; y < l->side; y++) {
        growth_begin(&l->grown);
        for (int dy = -LIGHT_GROW; dy <= LIGHT_GROW; dy++) {
            growth_add(&l->grown, l->marks + (size_t)(y + dy + LIGHT_GROW) * marks_stride(l),
                       dy < 0 ? -dy : dy, LIGHT_GROW);
        }
        growth_finish(&l->grown, l->mask + (ptrdiff_t)y * l->side);
    }
}

/* One row of the box. */
typedef struct row {
    const int32_t *owner;
    const uint8_t *defect;
    uint8_t *mask, *away, *own;
} row;

/* Finish the masks of a row; count what is found in its light in columns first .. end-1. */
SHEAR_SIMD static void find_light(row r, int n, const place *g, double half, int first, int end,
                                  int found[3]) {
    for (int x = 0; x < n; x++) {
        const int own = g->owner != 0 && r.owner[x] == g->owner;
        const int lit = own || fabs(x + LIGHT_GROW - g->x) <= half;
        const int inside = lit && x >= first && x < end;
        const int defect = r.defect[x];
        found[0] += inside && defect != 0 && (defect & PIXEL_SATURATED) == 0;
        found[1] += inside && (defect & PIXEL_SATURATED) != 0;
        found[2] += inside && r.mask[x] != 0;
        r.mask[x] |= defect != 0;
        r.away[x] = (uint8_t)(r.mask[x] | own);
        r.own[x] = (uint8_t)lit;
    }
}

static uint32_t find_all(light *l, const place *g) {
    const int n = l->side;
    int found[3] = {0};
    for (int y = 0; y < n; y++) {
        const ptrdiff_t at = (ptrdiff_t)y * n;
        const row r = {l->owner + (ptrdiff_t)(y + LIGHT_GROW) * wide(l) + LIGHT_GROW,
                       l->defect + at, l->mask + at, l->away + at, l->own + at};
        const bool in_stamp = y >= l->frame && y < n - l->frame;
        find_light(r, n, g, half_chord(g->r, y + LIGHT_GROW - g->y), l->frame,
                   in_stamp ? n - l->frame : 0, found);
    }
    return (found[0] > 0 ? SHEAR_FLAG_HOLE : 0U) | (found[1] > 0 ? SHEAR_FLAG_SATURATED : 0U) |
           (found[2] > 0 ? SHEAR_FLAG_NEIGHBOUR : 0U);
}

uint32_t light_find(light *l, double x, double y, double r_gal, int32_t owner) {
    const ptrdiff_t middle = l->side / 2 + LIGHT_GROW;
    place g = {.x = x + LIGHT_GROW, .y = y + LIGHT_GROW, .owner = owner};
    if (g.owner == 0)
        g.owner = l->owner[middle * wide(l) + middle];
    g.r = psf_radii * l->r_psf_px;
    g.r = r_gal > 0.0 ? g.r + r_gal : fmax(g.r, extent(l, &g));
    g.r_near = g.r + fmax(LIGHT_GROW, psf_radii_beyond * l->r_psf_px);
    const bool near = find_others(l, &g);
    grow_others(l);
    return find_all(l, &g) | (near ? SHEAR_FLAG_NEIGHBOUR : 0U);
}

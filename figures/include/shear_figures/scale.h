/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_figures/scale.h: from numbers to positions, brightness and colours; no drawing. */
#ifndef SHEAR_FIGURES_SCALE_H
#define SHEAR_FIGURES_SCALE_H

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

/* ---- ranges ---- */

typedef struct shear_range {
    double lo, hi;
} shear_range;

/* The smallest range that holds the finite ones of v[n]; {NaN, NaN} where there is none. */
shear_range shear_range_of(const double *v, size_t n);
/* The smallest range that holds both; a NaN range adds nothing. */
shear_range shear_range_join(shear_range a, shear_range b);
/* Widened on each side by `part` of its width. A range without width becomes one around its value,
 * a NaN range becomes [0, 1]: the answer can always be drawn. */
shear_range shear_range_pad(shear_range r, double part);
/* *out = the two percentiles (0..100, linear between order statistics) of the finite ones of v[n];
 * {NaN, NaN} where there is none. SHEAR_E_NOMEM. */
int shear_range_percentile(shear_range *out, const double *v, size_t n, double lo_percent,
                           double hi_percent, shear_error *err);

/* counts[bins] = how many of v[n] fall into each of `bins` equal bins of r, the last bin closed.
 * Returns how many finite values fell outside. */
size_t shear_histogram(double *counts, int bins, shear_range r, const double *v, size_t n);

/* ---- stretches: how a pixel's value becomes a brightness ---- */

enum shear_stretch_kind { SHEAR_LINEAR = 0, SHEAR_ASINH, SHEAR_LOG };

typedef struct shear_stretch {
    enum shear_stretch_kind kind;
    shear_range span; /* shown from the darkest to the brightest colour */
    double knee;      /* SHEAR_ASINH: values below it are linear, above it logarithmic */
} shear_stretch;

/* A stretch that can be used: a span without width or not finite is widened as by shear_range_pad;
 * a log's lower end that is not positive becomes 1e-4 of the upper; a knee that is not positive
 * becomes 1/20 of the larger end. */
shear_stretch shear_stretch_make(enum shear_stretch_kind kind, shear_range span, double knee);
/* The brightness of `value`: 0 at span.lo, 1 at span.hi, clamped to [0, 1], never decreasing; NaN
 * stays NaN. */
double shear_stretch_apply(const shear_stretch *s, double value);

/* ---- ticks ---- */

enum { SHEAR_MAX_TICKS = 16, SHEAR_TICK_LABEL = 32 };

typedef struct shear_ticks {
    int n;
    double at[SHEAR_MAX_TICKS];                    /* increasing */
    char label[SHEAR_MAX_TICKS][SHEAR_TICK_LABEL]; /* marked-up text, see figure.h */
    int exponent; /* the labels are to be multiplied by 10^exponent; 0 where they stand for
                     themselves */
} shear_ticks;

/* Multiples of a step 1, 2 or 5 times 10^k within [lo, hi]: the finest step that gives no more than
 * `at_most` (2..SHEAR_MAX_TICKS). None where lo < hi does not hold or either is not finite. */
void shear_ticks_linear(shear_ticks *t, double lo, double hi, int at_most);
/* Powers of ten, every 1st, 2nd, ... so that there are no more than at_most; where fewer than two
 * fit, 1, 2 and 5 times powers of ten; where even these are fewer than two, as shear_ticks_linear.
 * None where 0 < lo < hi fails or lo is subnormal. */
void shear_ticks_log(shear_ticks *t, double lo, double hi, int at_most);
/* For a colour bar: values whose brightnesses are at least 1/at_most apart. */
void shear_ticks_stretch(shear_ticks *t, const shear_stretch *s, int at_most);

/* ---- colours ---- */

typedef struct shear_colour {
    double r, g, b, a; /* sRGB and opacity, 0..1 */
} shear_colour;

/* Eight colours that readers of every kind of colour vision can tell apart; black first, then round
 * again. */
enum shear_hue {
    SHEAR_BLACK = 0,
    SHEAR_BLUE,
    SHEAR_VERMILION,
    SHEAR_GREEN,
    SHEAR_PURPLE,
    SHEAR_ORANGE,
    SHEAR_SKY,
    SHEAR_GREY,
    SHEAR_N_HUES
};
shear_colour shear_palette(int i);
shear_colour shear_palette_faint(int i, double opacity);

/* SHEAR_MAP_UNIFORM: from dark violet over teal to yellow, equal steps in OKLab lightness;
 * SHEAR_MAP_GREY: black to white, equal steps in lightness too. */
enum shear_map { SHEAR_MAP_UNIFORM = 0, SHEAR_MAP_GREY };
/* The colour of brightness t (clamped to [0, 1]); `map` as above. */
shear_colour shear_map_colour(enum shear_map map, double t);
/* Pixels that are not finite, and negative ones where they are marked. */
shear_colour shear_map_not_finite(void);
shear_colour shear_map_negative(void);

#endif

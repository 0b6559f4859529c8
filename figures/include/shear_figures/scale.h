/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_figures/scale.h: conversion of numbers to positions, brightness and colours, without
 * drawing. */
#ifndef SHEAR_FIGURES_SCALE_H
#define SHEAR_FIGURES_SCALE_H

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

/* ---- ranges ---- */

typedef struct shear_range {
    double lo, hi;
} shear_range;

/* Return the smallest range of the finite values in v[n]; {NaN, NaN} if there are none. */
shear_range shear_range_of(const double *v, size_t n);
/* Return the smallest range that includes both; a NaN range is ignored. */
shear_range shear_range_join(shear_range a, shear_range b);
/* Return r, widened on each side by `part` of its width. A range without width becomes one around
 * its value, a NaN range becomes [0, 1]: the result can always be drawn. */
shear_range shear_range_pad(shear_range r, double part);
/* Set *out to two percentiles (0..100, linear between order statistics) of the finite values in
 * v[n]; {NaN, NaN} if there are none. Returns SHEAR_OK or SHEAR_E_NOMEM. */
int shear_range_percentile(shear_range *out, const double *v, size_t n, double lo_percent,
                           double hi_percent, shear_error *err);

/* Set counts[bins] to the numbers of v[n] in each of `bins` equal bins of r, the last bin closed.
 * Returns how many finite values are outside. */
size_t shear_histogram(double *counts, int bins, shear_range r, const double *v, size_t n);

/* ---- stretches: the brightness of a pixel's value ---- */

enum shear_stretch_kind { SHEAR_LINEAR = 0, SHEAR_ASINH, SHEAR_LOG };

typedef struct shear_stretch {
    enum shear_stretch_kind kind;
    shear_range span; /* displayed, from the darkest to the brightest colour */
    double knee;      /* for SHEAR_ASINH: linear below, logarithmic above */
} shear_stretch;

/* Return a usable stretch: a span without width or not finite is widened as by shear_range_pad; a
 * log's lower end that is not positive becomes 1e-4 of the upper end; a knee that is not positive
 * becomes 1/20 of the larger end. */
shear_stretch shear_stretch_make(enum shear_stretch_kind kind, shear_range span, double knee);
/* Return the brightness of `value`: 0 at span.lo, 1 at span.hi, clamped to [0, 1], never
 * decreasing; NaN for NaN. */
double shear_stretch_apply(const shear_stretch *s, double value);

/* ---- ticks ---- */

enum { SHEAR_MAX_TICKS = 16, SHEAR_TICK_LABEL = 32 };

typedef struct shear_ticks {
    int n;
    double at[SHEAR_MAX_TICKS];                    /* increasing */
    char label[SHEAR_MAX_TICKS][SHEAR_TICK_LABEL]; /* marked-up text, see figure.h */
    int exponent; /* the labels must be multiplied by 10^exponent; 0 if they are the values */
} shear_ticks;

/* Compute ticks at multiples of 1, 2 or 5 times 10^k within [lo, hi], with the smallest step that
 * gives at most `at_most` (2..SHEAR_MAX_TICKS). There are none unless lo < hi and both are finite.
 */
void shear_ticks_linear(shear_ticks *t, double lo, double hi, int at_most);
/* Compute ticks at powers of ten, or at every 2nd, 3rd, ... so that there are at most at_most. If
 * fewer than two fit, use 1, 2 and 5 times powers of ten; if these are fewer than two, use
 * shear_ticks_linear. There are none unless 0 < lo < hi, or if lo is subnormal. */
void shear_ticks_log(shear_ticks *t, double lo, double hi, int at_most);
/* Compute ticks of a colour bar: values whose brightnesses differ by at least 1/at_most. */
void shear_ticks_stretch(shear_ticks *t, const shear_stretch *s, int at_most);

/* ---- colours ---- */

typedef struct shear_colour {
    double r, g, b, a; /* sRGB and opacity, 0..1 */
} shear_colour;

/* Eight colours that readers with any colour vision can distinguish; black first. Larger numbers
 * repeat them. */
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

/* SHEAR_MAP_UNIFORM: dark violet over teal to yellow, in equal steps of OKLab lightness.
 * SHEAR_MAP_GREY: black to white, also in equal steps of lightness. */
enum shear_map { SHEAR_MAP_UNIFORM = 0, SHEAR_MAP_GREY };
/* Return the colour of brightness t, which is clamped to [0, 1]. */
shear_colour shear_map_colour(enum shear_map map, double t);
/* Return the colour of pixels that are not finite; below, of negative pixels that are marked. */
shear_colour shear_map_not_finite(void);
shear_colour shear_map_negative(void);

#endif

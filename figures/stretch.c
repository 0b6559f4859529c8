/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ranges, percentiles, histograms and stretches. */
#include "shear_figures/scale.h"

#include "base/sort.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* The width of an axis or a span must be larger than rounding errors. */
static const double SMALLEST_RELATIVE_WIDTH = 1e-12;
static const double LOG_DEPTH = 1e-4;     /* of a log stretch whose lower end is not positive */
static const double KNEE_PART = 1.0 / 20; /* of an asinh stretch's larger end */

shear_range shear_range_of(const double *v, size_t n) {
    shear_range r = {NAN, NAN};
    for (size_t i = 0; i < n; i++) {
        if (isfinite(v[i])) {
            r.lo = fmin(r.lo, v[i]); /* fmin and fmax ignore NaN */
            r.hi = fmax(r.hi, v[i]);
        }
    }
    return r;
}

shear_range shear_range_join(shear_range a, shear_range b) {
    return (shear_range){fmin(a.lo, b.lo), fmax(a.hi, b.hi)};
}

shear_range shear_range_pad(shear_range r, double part) {
    if (!isfinite(r.lo) || !isfinite(r.hi))
        return (shear_range){0.0, 1.0};
    if (r.lo > r.hi)
        r = (shear_range){r.hi, r.lo};
    const double magnitude = fmax(fabs(r.lo), fabs(r.hi));
    const double width = r.hi / 2 - r.lo / 2; /* half, because the full width may overflow */
    if (width <= SMALLEST_RELATIVE_WIDTH * magnitude) {
        const double half = magnitude > 0.0 ? 0.05 * magnitude : 0.5;
        return (shear_range){r.lo - half, r.hi + half};
    }
    return (shear_range){r.lo - 2 * width * part, r.hi + 2 * width * part};
}

/* Interpolate between order statistics; sorted[n], n >= 1. */
static double percentile_of_sorted(const double *sorted, size_t n, double percent) {
    const double place = fmin(fmax(percent, 0.0), 100.0) / 100.0 * (double)(n - 1);
    const size_t below = (size_t)place;
    if (below + 1 >= n)
        return sorted[n - 1];
    const double part = place - (double)below;
    return sorted[below] * (1.0 - part) + sorted[below + 1] * part;
}

int shear_range_percentile(shear_range *out, const double *v, size_t n, double lo_percent,
                           double hi_percent, shear_error *err) {
    *out = (shear_range){NAN, NAN};
    double *sorted =
        n <= SIZE_MAX / sizeof *sorted ? malloc((n != 0 ? n : 1) * sizeof *sorted) : NULL;
    if (sorted == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory to sort %zu values", n);
    size_t finite = 0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(v[i]))
            sorted[finite++] = v[i];
    }
    if (finite > 0) {
        sort_doubles(sorted, finite);
        out->lo = percentile_of_sorted(sorted, finite, lo_percent);
        out->hi = percentile_of_sorted(sorted, finite, hi_percent);
    }
    free(sorted);
    return SHEAR_OK;
}

size_t shear_histogram(double *counts, int bins, shear_range r, const double *v, size_t n) {
    for (int b = 0; b < bins; b++)
        counts[b] = 0.0;
    size_t outside = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(v[i]))
            continue;
        if (!(v[i] >= r.lo && v[i] <= r.hi) || bins < 1) {
            outside++;
            continue;
        }
        const double place = (v[i] - r.lo) / (r.hi - r.lo) * bins;
        const int bin = place < bins ? (int)place : bins - 1;
        counts[bin] += 1.0;
    }
    return outside;
}

shear_stretch shear_stretch_make(enum shear_stretch_kind kind, shear_range span, double knee) {
    shear_stretch s = {.kind = kind, .span = span, .knee = knee};
    if (kind == SHEAR_LOG && isfinite(span.hi)) {
        s.span.hi = span.hi > 0.0 ? span.hi : 1.0;
        if (!(span.lo > 0.0 && span.lo < s.span.hi))
            s.span.lo = s.span.hi * LOG_DEPTH;
    } else if (kind == SHEAR_LOG) {
        s.span = (shear_range){LOG_DEPTH, 1.0};
    } else {
        s.span = shear_range_pad(span, 0.0);
    }
    if (!(knee > 0.0 && isfinite(knee)))
        s.knee = KNEE_PART * fmax(fabs(s.span.lo), fabs(s.span.hi));
    return s;
}

/* Return the monotonic function of the value to which the brightness is linear. */
static double stretched(const shear_stretch *s, double value) {
    switch (s->kind) {
    case SHEAR_ASINH:
        return asinh(value / s->knee);
    case SHEAR_LOG:
        return value > 0.0 ? log(value) : -INFINITY;
    default:
        return value / 2; /* half, because the difference of two may overflow */
    }
}

double shear_stretch_apply(const shear_stretch *s, double value) {
    if (isnan(value))
        return NAN;
    const double lo = stretched(s, s->span.lo);
    const double hi = stretched(s, s->span.hi);
    const double t = (stretched(s, value) - lo) / (hi - lo);
    return fmin(fmax(t, 0.0), 1.0);
}

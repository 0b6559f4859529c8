/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/axis.h"
#include "base/simd.h"
#include "fft/fft.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static axis_weights weights(enum axis_kind kind, double t) {
    const double u = 1.0 - t;
    switch (kind) {
    case AXIS_CUBIC:
        /* Cubic Hermite basis: eq. (15) of Zhang (2010), and its derivatives at the cell's ends, in
         * one dimension. */
        return (axis_weights){.a = (1.0 + 2.0 * t) * u * u,
                              .b = t * t * (3.0 - 2.0 * t),
                              .c = t * u * u,
                              .d = -t * t * u};
    case AXIS_SPLINE:
        /* Zhang (2010), eq. (18), with unit spacing: a = H, b = K, c = U, d = V. */
        return (axis_weights){
            .a = u, .b = t, .c = (u * u * u - u) / 6.0, .d = (t * t * t - t) / 6.0};
    default:
        return (axis_weights){.a = u, .b = t};
    }
}

/* The spline's equations e_{i-1} + 4 e_i + e_{i+1} = 6 (f_{i+1} - 2 f_i + f_{i-1}) for the inner
 * points of a line whose end points have e = 0, eliminated forward: pivot_i = 1 / (4 -
 * pivot_{i-1}). The factors depend only on the distance from the line's start, so every stretch of
 * a broken line uses them from its own beginning. */
static void fill_pivots(double *pivot, int n) {
    pivot[0] = 0.0;
    for (int i = 1; i < n; i++)
        pivot[i] = 1.0 / (4.0 - pivot[i - 1]);
}

static axis_point point(enum axis_kind kind, int n, int s, int fine) {
    const int left = fine / s;
    const bool closing = left == n - 1;
    const double t = (double)(fine % s) / s;
    return (axis_point){.w = weights(closing ? AXIS_LINEAR : kind, t),
                        .left = left,
                        .right = closing ? 0 : left + 1,
                        .on_grid = fine % s == 0};
}

void axis_place(axis *ax, enum axis_kind kind, int n, int s, arena *a) {
    assert(n >= 2 && s >= 1);
    const size_t fine = (size_t)n * (size_t)s;
    *ax = (axis){.kind = kind, .n = n, .s = s};
    ax->points = arena_take(a, (fine + FFT_LANES) * sizeof *ax->points);
    ax->pivot = arena_doubles(a, (size_t)n);
    if (a->memory == NULL)
        return;
    for (size_t i = 0; i < fine; i++)
        ax->points[i] = point(kind, n, s, (int)i);
    fill_pivots(ax->pivot, n);
}

/* Zhang (2010), eq. (14): central differences, one-sided at the two ends. */
SHEAR_SIMD static void cubic_slopes(int n, const double *f, double *e, size_t stride, int lanes) {
    for (int i = 0; i < n; i++) {
        const double *before = f + (size_t)(i > 0 ? i - 1 : i) * stride;
        const double *after = f + (size_t)(i < n - 1 ? i + 1 : i) * stride;
        const double scale = i > 0 && i < n - 1 ? 0.5 : 1.0;
        double *out = e + (size_t)i * stride;
#pragma omp simd
        for (int l = 0; l < lanes; l++)
            out[l] = scale * (after[l] - before[l]);
    }
}

SHEAR_SIMD static void spline_slopes(const double *pivot, int n, const double *f, double *e,
                                     size_t stride, int lanes) {
    for (int l = 0; l < lanes; l++)
        e[l] = 0.0;
    for (int i = 1; i < n - 1; i++) {
        const double *at = f + (size_t)i * stride;
        double *out = e + (size_t)i * stride;
        const double p = pivot[i];
#pragma omp simd
        for (int l = 0; l < lanes; l++) {
            const double curve =
                6.0 * (at[l + (ptrdiff_t)stride] - 2.0 * at[l] + at[l - (ptrdiff_t)stride]);
            out[l] = p * (curve - out[l - (ptrdiff_t)stride]);
        }
    }
    for (int l = 0; l < lanes; l++)
        e[(size_t)(n - 1) * stride + (size_t)l] = 0.0;
    for (int i = n - 2; i > 0; i--) {
        double *out = e + (size_t)i * stride;
        const double p = pivot[i];
#pragma omp simd
        for (int l = 0; l < lanes; l++)
            out[l] -= p * out[l + (ptrdiff_t)stride];
    }
}

/* Fill the slopes of n consecutive points. */
static void fill_slopes(const axis *ax, int n, const double *f, double *e, size_t stride,
                        int lanes) {
    if (ax->kind == AXIS_CUBIC) {
        cubic_slopes(n, f, e, stride, lanes);
    } else if (ax->kind == AXIS_SPLINE) {
        spline_slopes(ax->pivot, n, f, e, stride, lanes);
    } else { /* their weights are 0, but they must be finite */
        for (int i = 0; i < n; i++)
            memset(e + (size_t)i * stride, 0, (size_t)lanes * sizeof *e);
    }
}

void axis_slopes(const axis *ax, const double *f, double *e, size_t stride, int lanes) {
    fill_slopes(ax, ax->n, f, e, stride, lanes);
}

static bool is_mark(double f) {
    return f == -INFINITY;
}

void axis_slopes_marked(const axis *ax, const double *marks, const double *f, double *e,
                        size_t stride) {
    int i = 0;
    while (i < ax->n) {
        e[(size_t)i * stride] = 0.0;
        if (is_mark(marks[(size_t)i * stride])) {
            i++;
            continue;
        }
        int end = i + 1;
        while (end < ax->n && !is_mark(marks[(size_t)end * stride]))
            end++;
        fill_slopes(ax, end - i, f + (size_t)i * stride, e + (size_t)i * stride, stride, 1);
        i = end;
    }
}

double axis_between_marks(const axis_point *p, double f_left, double f_right, double e_left,
                          double e_right) {
    if (p->on_grid)
        return f_left;
    return is_mark(f_left) || is_mark(f_right)
               ? -INFINITY
               : p->w.a * f_left + p->w.b * f_right + p->w.c * e_left + p->w.d * e_right;
}

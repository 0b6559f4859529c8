/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/axis.h"
#include "base/simd.h"

#include <math.h>
#include <stdlib.h>

static axis_weights linear_weights(double t) {
    return (axis_weights){.a = 1.0 - t, .b = t};
}

/* Cubic Hermite basis: what label A_bicubic and its derivatives at the cell's ends amount to in one
 * dimension. */
static axis_weights hermite_weights(double t) {
    const double u = 1.0 - t;
    return (axis_weights){.a = (1.0 + 2.0 * t) * u * u,
                          .b = t * t * (3.0 - 2.0 * t),
                          .c = t * u * u,
                          .d = -t * t * u};
}

/* Label HKUV with unit spacing: a = H, b = K, c = U, d = V. */
static axis_weights spline_weights(double t) {
    const double h = 1.0 - t;
    return (axis_weights){.a = h, .b = t, .c = (h * h * h - h) / 6.0, .d = (t * t * t - t) / 6.0};
}

static axis_weights weights(int kind, double t) {
    switch (kind) {
    case AXIS_CUBIC:
        return hermite_weights(t);
    case AXIS_SPLINE:
        return spline_weights(t);
    default:
        return linear_weights(t);
    }
}

/* The spline's equations e_{i-1} + 4 e_i + e_{i+1} = 6 (f_{i+1} - 2 f_i + f_{i-1}) for the inner
 * points of a line whose end points have e = 0, eliminated forward: pivot_i = 1 / (4 -
 * pivot_{i-1}). The factors depend only on the distance from the line's start, so every stretch of
 * a broken line uses them from its own beginning. */
static void fill_pivots(double *pivot, int n) {
    pivot[0] = 0.0;
    for (int i = 1; i < n; i++) {
        pivot[i] = 1.0 / (4.0 - pivot[i - 1]);
    }
}

bool axis_init(axis *ax, int kind, int n, int s) {
    *ax = (axis){.kind = kind, .n = n, .s = s};
    ax->phase = malloc((size_t)s * sizeof *ax->phase);
    ax->a = malloc(4 * (size_t)s * sizeof *ax->a);
    ax->pivot = malloc((size_t)n * sizeof *ax->pivot);
    if (ax->phase == NULL || ax->a == NULL || ax->pivot == NULL) {
        return false;
    }
    ax->b = ax->a + s;
    ax->c = ax->b + s;
    ax->d = ax->c + s;
    for (int p = 0; p < s; p++) {
        const axis_weights w = weights(kind, (double)p / s);
        ax->phase[p] = w;
        ax->a[p] = w.a;
        ax->b[p] = w.b;
        ax->c[p] = w.c;
        ax->d[p] = w.d;
    }
    fill_pivots(ax->pivot, n);
    return true;
}

void axis_deinit(axis *ax) {
    free(ax->phase);
    free(ax->a);
    free(ax->pivot);
    *ax = (axis){0};
}

axis_weights axis_at(const axis *ax, int fine, int *left, int *right) {
    const int phase = fine % ax->s;
    *left = fine / ax->s;
    if (*left < ax->n - 1) {
        *right = *left + 1;
        return ax->phase[phase];
    }
    *right = 0;
    return linear_weights((double)phase / ax->s);
}

/* Label dAdxdy: central differences, one-sided at the two ends. */
SHEAR_SIMD static void cubic_slopes(int n, const double *f, double *e, size_t stride, int lanes) {
    for (int i = 0; i < n; i++) {
        const double *before = f + (size_t)(i > 0 ? i - 1 : i) * stride;
        const double *after = f + (size_t)(i < n - 1 ? i + 1 : i) * stride;
        const double scale = i > 0 && i < n - 1 ? 0.5 : 1.0;
        double *out = e + (size_t)i * stride;
#pragma omp simd
        for (int l = 0; l < lanes; l++) {
            out[l] = scale * (after[l] - before[l]);
        }
    }
}

SHEAR_SIMD static void spline_slopes(const double *pivot, int n, const double *f, double *e,
                                     size_t stride, int lanes) {
    for (int l = 0; l < lanes; l++) {
        e[l] = 0.0;
    }
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
    for (int l = 0; l < lanes; l++) {
        e[(size_t)(n - 1) * stride + (size_t)l] = 0.0;
    }
    for (int i = n - 2; i > 0; i--) {
        double *out = e + (size_t)i * stride;
        const double p = pivot[i];
#pragma omp simd
        for (int l = 0; l < lanes; l++) {
            out[l] -= p * out[l + (ptrdiff_t)stride];
        }
    }
}

void axis_slopes(const axis *ax, const double *f, double *e, size_t stride, int lanes) {
    if (ax->kind == AXIS_CUBIC) {
        cubic_slopes(ax->n, f, e, stride, lanes);
    } else if (ax->kind == AXIS_SPLINE) {
        spline_slopes(ax->pivot, ax->n, f, e, stride, lanes);
    }
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
        while (end < ax->n && !is_mark(marks[(size_t)end * stride])) {
            end++;
        }
        const double *run_f = f + (size_t)i * stride;
        double *run_e = e + (size_t)i * stride;
        if (ax->kind == AXIS_CUBIC) {
            cubic_slopes(end - i, run_f, run_e, stride, 1);
        } else if (ax->kind == AXIS_SPLINE) {
            spline_slopes(ax->pivot, end - i, run_f, run_e, stride, 1);
        } else {
            for (int k = i; k < end; k++) {
                e[(size_t)k * stride] = 0.0;
            }
        }
        i = end;
    }
}

/* All phases of one cell: a f_i + b f_j + c e_i + d e_j. */
SHEAR_SIMD static void expand_cells(const axis *ax, const double *f, const double *e,
                                    size_t e_stride, double *fine) {
    const int s = ax->s;
    const double *a = ax->a;
    const double *b = ax->b;
    const double *c = ax->c;
    const double *d = ax->d;
    for (int i = 0; i < ax->n - 1; i++) {
        double *cell = fine + (size_t)i * (size_t)s;
        const double fi = f[i];
        const double fj = f[i + 1];
        const double ei = e[(size_t)i * e_stride];
        const double ej = e[(size_t)(i + 1) * e_stride];
#pragma omp simd
        for (int p = 0; p < s; p++) {
            cell[p] = a[p] * fi + b[p] * fj + c[p] * ei + d[p] * ej;
        }
    }
}

/* The cell from f_i to f_j, where it is linear. */
static void expand_linear(double fi, double fj, int s, double *cell) {
    for (int p = 0; p < s; p++) {
        const axis_weights w = linear_weights((double)p / s);
        cell[p] = w.a * fi + w.b * fj;
    }
}

/* Over what the smooth rule made: cells that touch a mark. */
static void mark_cells(const axis *ax, const double *f, double *fine) {
    for (int i = 0; i < ax->n; i++) {
        double *cell = fine + (size_t)i * (size_t)ax->s;
        if (is_mark(f[i]) || is_mark(f[i < ax->n - 1 ? i + 1 : 0])) {
            cell[0] = f[i];
            for (int p = 1; p < ax->s; p++) {
                cell[p] = -INFINITY;
            }
        }
    }
}

void axis_expand(const axis *ax, const double *f, const double *e, size_t e_stride, bool marked,
                 double *fine) {
    const int last = ax->n - 1;
    if (ax->kind == AXIS_LINEAR) {
        for (int i = 0; i < last; i++) {
            expand_linear(f[i], f[i + 1], ax->s, fine + (size_t)i * (size_t)ax->s);
        }
    } else {
        expand_cells(ax, f, e, e_stride, fine);
    }
    expand_linear(f[last], f[0], ax->s, fine + (size_t)last * (size_t)ax->s);
    if (marked) {
        mark_cells(ax, f, fine);
    }
}

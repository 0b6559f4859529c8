/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/moments.h"
#include "base/simd.h"

#include <math.h>

static size_t wrap(int j, int n) {
    return (size_t)(j < 0 ? j + n : j);
}

double moments_power(const mode_columns *c, const transfer_plan *p, int lane, int jy) {
    const int ny = p->ny * p->s;
    const double complex here = c->left[wrap(jy, ny) * FFT_LINES + (size_t)lane];
    const double complex there = c->right[wrap(-jy, ny) * FFT_LINES + FFT_LINES - 1 - (size_t)lane];
    return creal(here) * creal(there) - cimag(here) * cimag(there);
}

/* Sums over jy of T P times 1, jy, jy^2, jy^3, jy^4, a column a lane: the powers of jx are the same
 * all along a column and come in at the end. */
typedef struct lane_sums {
    double s[5][FFT_LINES];
} lane_sums;

/* Modes of row jy (here) and -jy (there), interleaved re, im; the mirror images lie in the opposite
 * order. */
static inline void add_row(lane_sums *sums, const double *here, const double *there,
                           const double *t, double y) {
    const double y2 = y * y;
#pragma omp simd
    for (int l = 0; l < FFT_LINES; l++) {
        const int m = FFT_LINES - 1 - l;
        const double tp = t[l] * (here[2 * l] * there[2 * m] - here[2 * l + 1] * there[2 * m + 1]);
        sums->s[0][l] += tp;
        sums->s[1][l] += y * tp;
        sums->s[2][l] += y2 * tp;
        sums->s[3][l] += y2 * y * tp;
        sums->s[4][l] += y2 * y2 * tp;
    }
}

SHEAR_SIMD static void sum_columns(const double *left, const double *right, const double *t,
                                   size_t t_stride, int ny, int last, lane_sums *out) {
    lane_sums sums = {0};
    enum { ROW = 2 * FFT_LINES };
    add_row(&sums, left, right, t, 0.0);
    for (int jy = 1; jy <= last; jy++) {
        const double *up = t + (ptrdiff_t)t_stride * jy;
        const double *down = t - (ptrdiff_t)t_stride * jy;
        add_row(&sums, left + ROW * jy, right + ROW * (ny - jy), up, jy);
        add_row(&sums, left + ROW * (ny - jy), right + ROW * jy, down, -jy);
    }
    *out = sums;
}

void moments_add(moments *m, const mode_columns *c, const transfer_plan *p, const transfer *t) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    const double *middle =
        t->t + (size_t)p->max_jy * p->stride + (size_t)c->group * FFT_LINES; /* jy = 0 */
    lane_sums sums;
    sum_columns((const double *)c->left, (const double *)c->right, middle, p->stride, p->ny * p->s,
                t->jy, &sums);
    for (int l = 0; l < FFT_LINES; l++) {
        const double x = ux * (c->group * FFT_LINES + l);
        const double x2 = x * x;
        const double s0 = sums.s[0][l];
        const double y1 = uy * sums.s[1][l];
        const double y2 = uy * uy * sums.s[2][l];
        const double y3 = uy * uy * uy * sums.s[3][l];
        const double y4 = uy * uy * uy * uy * sums.s[4][l];
        m->m20 += x2 * s0;
        m->m02 += y2;
        m->m11 += x * y1;
        m->m4 += x2 * x2 * s0 + 2.0 * x2 * y2 + y4;
        m->u += x2 * x2 * s0 - 6.0 * x2 * y2 + y4;
        m->v += x2 * x * y1 - x * y3;
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/moments.h"
#include "base/simd.h"

#include <math.h>

static size_t wrap(int j, int n) {
    return (size_t)(j < 0 ? j + n : j);
}

double moments_power(const double complex *z, size_t stride, const transfer_plan *p, int jx,
                     int jy) {
    const int nx = p->nx * p->s;
    const int ny = p->ny * p->s;
    const double complex here = z[wrap(jy, ny) * stride + wrap(jx, nx)];
    const double complex there = z[wrap(-jy, ny) * stride + wrap(-jx, nx)];
    return creal(here) * creal(there) - cimag(here) * cimag(there);
}

/* Sums over one row of modes of T P times 1, jx, jx^2, jx^3, jx^4. */
typedef struct row_sums {
    double s0, s1, s2, s3, s4;
} row_sums;

/* here: modes (0 .. jx, jy); there: the row of -jy, whose mode -jx lies at [nx - jx]. Interleaved
 * re, im. */
SHEAR_SIMD static row_sums sum_row(const double *here, const double *there, const double *t, int nx,
                                   int last, double flat) {
    const double power0 = here[0] * there[0] - here[1] * there[1] - flat;
    double s0 = t[0] * power0;
    double s1 = 0.0;
    double s2 = 0.0;
    double s3 = 0.0;
    double s4 = 0.0;
#pragma omp simd reduction(+ : s0, s1, s2, s3, s4)
    for (int jx = 1; jx <= last; jx++) {
        const double *b = there + 2 * (ptrdiff_t)(nx - jx);
        const double tp = t[jx] * (here[2 * jx] * b[0] - here[2 * jx + 1] * b[1] - flat);
        const double x = jx;
        const double x2 = x * x;
        s0 += tp;
        s1 += x * tp;
        s2 += x2 * tp;
        s3 += x2 * x * tp;
        s4 += x2 * x2 * tp;
    }
    return (row_sums){s0, s1, s2, s3, s4};
}

moments moments_of(const double complex *z, size_t stride, const transfer_plan *p,
                   const transfer *t, double flat) {
    const int nx = p->nx * p->s;
    const int ny = p->ny * p->s;
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    moments m = {0};
    for (int jy = -t->jy; jy <= t->jy; jy++) {
        const double *here = (const double *)(z + wrap(jy, ny) * stride);
        const double *there = (const double *)(z + wrap(-jy, ny) * stride);
        const row_sums r =
            sum_row(here, there, t->t + (size_t)(jy + p->max_jy) * p->stride, nx, t->jx, flat);
        const double y = uy * jy;
        const double xx = ux * ux * r.s2;
        const double x4 = ux * ux * ux * ux * r.s4;
        const double y2 = y * y;
        m.m20 += xx;
        m.m02 += y2 * r.s0;
        m.m11 += y * ux * r.s1;
        m.m4 += x4 + 2.0 * y2 * xx + y2 * y2 * r.s0;
        m.u += x4 - 6.0 * y2 * xx + y2 * y2 * r.s0;
        m.v += y * ux * ux * ux * r.s3 - y2 * y * ux * r.s1;
    }
    return m;
}

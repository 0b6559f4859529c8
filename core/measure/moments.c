/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/moments.h"
#include "base/simd.h"

#include <math.h>
#include <string.h>

static size_t wrap(int j, int n) {
    return (size_t)(j < 0 ? j + n : j);
}

double moments_power(const mode_columns *c, const transfer_plan *p, int lane, int jy) {
    const int ny = p->ny * p->s;
    const double complex here = c->left[wrap(jy, ny) * FFT_LINES + (size_t)lane];
    const double complex there = c->right[wrap(-jy, ny) * FFT_LINES + (size_t)lane];
    return creal(here) * creal(there) - cimag(here) * cimag(there);
}

/* Sums over jy of T P times 1, jy, jy^2, jy^3, jy^4, a column a lane: the powers of jx are the same
 * all along a column and come in at the end. */
typedef struct lane_sums {
    double s0[FFT_LINES], s1[FFT_LINES], s2[FFT_LINES], s3[FFT_LINES], s4[FFT_LINES];
} lane_sums;

/* T P of row jy from its modes (here) and those of row -jy (there), interleaved re, im. */
static inline void weigh(const double *restrict here, const double *restrict there,
                         const double *restrict t, double *restrict tp) {
#pragma omp simd
    for (int l = 0; l < FFT_LINES; l++) {
        tp[l] = t[l] * (here[2 * l] * there[2 * l] - here[2 * l + 1] * there[2 * l + 1]);
    }
}

/* Rows jy and -jy together: their even powers add, their odd ones differ. */
static inline void add_rows(lane_sums *restrict sums, const double *restrict up,
                            const double *restrict down, double y) {
    const double y2 = y * y;
#pragma omp simd
    for (int l = 0; l < FFT_LINES; l++) {
        const double even = up[l] + down[l];
        const double odd = y * (up[l] - down[l]);
        sums->s0[l] += even;
        sums->s1[l] += odd;
        sums->s2[l] += y2 * even;
        sums->s3[l] += y2 * odd;
        sums->s4[l] += y2 * y2 * even;
    }
}

SHEAR_SIMD static void sum_columns(const double *left, const double *right, const double *t,
                                   size_t t_stride, int ny, int last, lane_sums *out) {
    enum { ROW = 2 * FFT_LINES };
    lane_sums sums = {0};
    double up[FFT_LINES];
    double down[FFT_LINES];
    weigh(left, right, t, sums.s0);
    for (int jy = 1; jy <= last; jy++) {
        const ptrdiff_t step = (ptrdiff_t)t_stride * jy;
        weigh(left + ROW * jy, right + ROW * (ny - jy), t + step, up);
        weigh(left + ROW * (ny - jy), right + ROW * jy, t - step, down);
        add_rows(&sums, up, down, jy);
    }
    *out = sums;
}

/* The sums of columns [first, first + FFT_LINES) to moments. */
static void add_lanes(moments *m, const lane_sums *sums, const transfer_plan *p, int first) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    for (int l = 0; l < FFT_LINES; l++) {
        const double x = ux * (first + l);
        const double x2 = x * x;
        const double s0 = sums->s0[l];
        const double y1 = uy * sums->s1[l];
        const double y2 = uy * uy * sums->s2[l];
        const double y3 = uy * uy * uy * sums->s3[l];
        const double y4 = uy * uy * uy * uy * sums->s4[l];
        m->m20 += x2 * s0;
        m->m02 += y2;
        m->m11 += x * y1;
        m->m4 += x2 * x2 * s0 + 2.0 * x2 * y2 + y4;
        m->u += x2 * x2 * s0 - 6.0 * x2 * y2 + y4;
        m->v += x2 * x * y1 - x * y3;
    }
}

/* T at (jx, 0). */
static const double *middle_row(const transfer_plan *p, const transfer *t, int jx) {
    return t->t + (size_t)p->max_jy * p->stride + (size_t)jx;
}

void moments_add(moments *m, const mode_columns *c, const transfer_plan *p, const transfer *t) {
    const int first = c->group * FFT_LINES;
    lane_sums sums;
    sum_columns((const double *)c->left, (const double *)c->right, middle_row(p, t, first),
                p->stride, p->ny * p->s, t->jy, &sums);
    add_lanes(m, &sums, p, first);
}

moments moments_of_flat(const transfer_plan *p, const transfer *t) {
    moments m = {0};
    for (int first = 0; first <= t->jx; first += FFT_LINES) {
        const double *middle = middle_row(p, t, first);
        lane_sums sums = {0};
        memcpy(sums.s0, middle, sizeof sums.s0);
        for (int jy = 1; jy <= t->jy; jy++) {
            const ptrdiff_t step = (ptrdiff_t)p->stride * jy;
            add_rows(&sums, middle + step, middle - step, jy);
        }
        add_lanes(&m, &sums, p, first);
    }
    return m;
}

void moments_subtract(moments *m, double power, const moments *flat) {
    m->m20 -= power * flat->m20;
    m->m02 -= power * flat->m02;
    m->m11 -= power * flat->m11;
    m->m4 -= power * flat->m4;
    m->u -= power * flat->u;
    m->v -= power * flat->v;
}

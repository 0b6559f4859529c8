/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/moments.h"

#include <math.h>
#include <string.h>

double moments_power(const mode_rows *r, int jx, int lane) {
    const size_t here = (size_t)(jx < 0 ? r->nx + jx : jx) * FFT_LANES + (size_t)lane;
    const size_t there = (size_t)(jx > 0 ? r->nx - jx : -jx) * FFT_LANES + (size_t)lane;
    return mode_difference(mode_at(r, here, there));
}

/* Sums over jx of T P times 1, jx, jx^2, jx^3, jx^4; lane l holds row l of the group. The powers of
 * jy are constant along a row and are multiplied in at the end. */
typedef struct lane_sums {
    double s0[FFT_LANES], s1[FFT_LANES], s2[FFT_LANES], s3[FFT_LANES], s4[FFT_LANES];
} lane_sums;

/* Add columns jx and -jx together: the sums for even powers add, those for odd powers subtract. */
static SHEAR_INLINE void add_columns(lane_sums *s, size_t l, double right, double left, double x) {
    const double x2 = x * x;
    const double even = right + left;
    const double odd = x * (right - left);
    s->s0[l] += even;
    s->s1[l] += odd;
    s->s2[l] += x2 * even;
    s->s3[l] += x2 * odd;
    s->s4[l] += x2 * x2 * even;
}

/* The spectra that are summed. */
enum spectra { DIFFERENCE, WITH_NOISE, CROSS };

static SHEAR_INLINE double cross(mode z) {
    return z.a * z.d + z.b * z.c;
}

/* Sum T times a spectrum over jx, one row of modes per lane; the noise's sums go to `other`. t: T
 * at jx = 0, [jx][stride]. */
static SHEAR_INLINE void sum_rows(const mode_rows *rows, const double *t, size_t stride, int last,
                                  enum spectra which, lane_sums *out, lane_sums *other) {
    const mode_rows r = *rows;
    const size_t end = (size_t)r.nx * FFT_LANES;
    lane_sums s = {0};
    lane_sums n = {0};
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++) {
        const mode z = mode_at(&r, l, l);
        s.s0[l] = t[l] * (which == CROSS ? cross(z) : mode_difference(z));
        n.s0[l] = which == WITH_NOISE ? t[l] * mode_noise(z) : 0.0;
    }
    for (int jx = 1; jx <= last; jx++) {
        const double *right = t + (ptrdiff_t)stride * jx;
        const double *left = t - (ptrdiff_t)stride * jx;
        const size_t at = (size_t)jx * FFT_LANES;
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            const mode z = mode_at(&r, at + l, end - at + l);
            const mode y = mode_at(&r, end - at + l, at + l);
            add_columns(&s, l, right[l] * (which == CROSS ? cross(z) : mode_difference(z)),
                        left[l] * (which == CROSS ? cross(y) : mode_difference(y)), jx);
            if (which == WITH_NOISE)
                add_columns(&n, l, right[l] * mode_noise(z), left[l] * mode_noise(y), jx);
        }
    }
    *out = s;
    *other = n;
}

SHEAR_SIMD static void sum_difference(const mode_rows *rows, const double *t, size_t stride,
                                      int last, lane_sums *out, lane_sums *other) {
    sum_rows(rows, t, stride, last, DIFFERENCE, out, other);
}

SHEAR_SIMD static void sum_with_noise(const mode_rows *rows, const double *t, size_t stride,
                                      int last, lane_sums *out, lane_sums *other) {
    sum_rows(rows, t, stride, last, WITH_NOISE, out, other);
}

SHEAR_SIMD static void sum_cross(const mode_rows *rows, const double *t, size_t stride, int last,
                                 lane_sums *out, lane_sums *other) {
    sum_rows(rows, t, stride, last, CROSS, out, other);
}

/* Compute the moments of each row. */
SHEAR_SIMD static void moments_of_lanes(const lane_sums *sums, double ux, double uy, int first,
                                        double (*out)[FFT_LANES]) {
#pragma omp simd
    for (int l = 0; l < FFT_LANES; l++) {
        const double y = uy * (first + l);
        const double y2 = y * y;
        const double s0 = sums->s0[l];
        const double x1 = ux * sums->s1[l];
        const double x2 = ux * ux * sums->s2[l];
        const double x3 = ux * ux * ux * sums->s3[l];
        const double x4 = ux * ux * ux * ux * sums->s4[l];
        out[0][l] = x2;
        out[1][l] = y2 * s0;
        out[2][l] = x1 * y;
        out[3][l] = x4 + 2.0 * x2 * y2 + y2 * y2 * s0;
        out[4][l] = x4 - 6.0 * x2 * y2 + y2 * y2 * s0;
        out[5][l] = x3 * y - x1 * y * y2;
        out[6][l] = x4 - y2 * y2 * s0;
        out[7][l] = x3 * y + x1 * y * y2;
    }
}

/* Add the sums of rows [first, first + FFT_LANES) to the moments. */
static void add_lanes(moments *m, const lane_sums *sums, const mode_plane *p, int first) {
    double lanes[8][FFT_LANES];
    moments_of_lanes(sums, 2.0 * M_PI / p->nx, 2.0 * M_PI / p->ny, first, lanes);
    m->m20 += fft_total(lanes[0]);
    m->m02 += fft_total(lanes[1]);
    m->m11 += fft_total(lanes[2]);
    m->m4 += fft_total(lanes[3]);
    m->u += fft_total(lanes[4]);
    m->v += fft_total(lanes[5]);
    m->c4 += fft_total(lanes[6]);
    m->s4 += fft_total(lanes[7]);
}

/* Return T at (0, jy). */
static const double *middle_column(const mode_plane *p, const transfer *t, int jy) {
    return t->t + mode_plane_column(p, 0) + (size_t)jy;
}

static void add(moments *m, moments *noise, const mode_rows *rows, const mode_plane *p,
                const transfer *t, enum spectra which) {
    const int first = rows->group * FFT_LANES;
    lane_sums sums;
    lane_sums noise_sums;
    void (*const sum)(const mode_rows *, const double *, size_t, int, lane_sums *, lane_sums *) =
        which == DIFFERENCE ? sum_difference
        : which == CROSS    ? sum_cross
                            : sum_with_noise;
    sum(rows, middle_column(p, t, first), p->stride, t->reach[rows->group], &sums, &noise_sums);
    add_lanes(m, &sums, p, first);
    if (noise != NULL)
        add_lanes(noise, &noise_sums, p, first);
}

void moments_add(moments *m, moments *noise, const mode_rows *rows, const mode_plane *p,
                 const transfer *t) {
    add(m, noise, rows, p, t, noise != NULL ? WITH_NOISE : DIFFERENCE);
}

void moments_add_cross(moments *m, const mode_rows *rows, const mode_plane *p, const transfer *t) {
    add(m, NULL, rows, p, t, CROSS);
}

moments moments_of_flat(const mode_plane *p, const transfer *t) {
    moments m = {0};
    for (int first = 0; first <= t->jy; first += FFT_LANES) {
        const double *middle = middle_column(p, t, first);
        lane_sums sums = {0};
        memcpy(sums.s0, middle, sizeof sums.s0);
        for (int jx = 1; jx <= t->jx; jx++) {
            const ptrdiff_t step = (ptrdiff_t)p->stride * jx;
            for (size_t l = 0; l < FFT_LANES; l++)
                add_columns(&sums, l, middle[step + (ptrdiff_t)l], middle[(ptrdiff_t)l - step], jx);
        }
        add_lanes(&m, &sums, p, first);
    }
    return m;
}

void moments_join(moments *m, double factor, const moments *other) {
    m->m20 += factor * other->m20;
    m->m02 += factor * other->m02;
    m->m11 += factor * other->m11;
    m->m4 += factor * other->m4;
    m->u += factor * other->u;
    m->v += factor * other->v;
    m->c4 += factor * other->c4;
    m->s4 += factor * other->s4;
}

/* ---- another frame ---- */

/* Multiply a polynomial c[0 .. degree] of (kx, ky), whose element i belongs to kx^(degree-i) ky^i,
 * by a kx + b ky. */
static void multiply(double *c, int degree, double a, double b) {
    c[degree + 1] = b * c[degree];
    for (int i = degree; i > 0; i--)
        c[i] = a * c[i] + b * c[i - 1];
    c[0] *= a;
}

/* Return the sum of qx^(degree-i) qy^i from the sums s[0 .. degree] of kx^(degree-j) ky^j. */
static double sum_of(const frame_map *m, int degree, int i, const double *s) {
    double c[5] = {1.0};
    double sum = 0.0;
    for (int n = 0; n < degree; n++)
        multiply(c, n, n < i ? m->a[2] : m->a[0], n < i ? m->a[3] : m->a[1]);
    for (int j = 0; j <= degree; j++)
        sum += c[j] * s[j];
    return sum / m->area;
}

void moments_take_to_frame(moments *sums, const frame_map *m) {
    const double s2[3] = {sums->m20, sums->m11, sums->m02};
    const double middle = 0.125 * (sums->m4 - sums->u);
    const double even = sums->m4 - 2.0 * middle;
    const double s4[5] = {0.5 * (even + sums->c4), 0.5 * (sums->s4 + sums->v), middle,
                          0.5 * (sums->s4 - sums->v), 0.5 * (even - sums->c4)};
    double q[5];
    for (int i = 0; i <= 4; i++)
        q[i] = sum_of(m, 4, i, s4);
    *sums = (moments){.m20 = sum_of(m, 2, 0, s2),
                      .m11 = sum_of(m, 2, 1, s2),
                      .m02 = sum_of(m, 2, 2, s2),
                      .m4 = q[0] + 2.0 * q[2] + q[4],
                      .u = q[0] - 6.0 * q[2] + q[4],
                      .v = q[1] - q[3],
                      .c4 = q[0] - q[4],
                      .s4 = q[1] + q[3]};
}

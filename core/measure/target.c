/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/target.h"

#include "base/simd.h"

#include <assert.h>

void target_place(target *t, const mode_plane *p, bool sky, arena *a) {
    t->q2 = arena_doubles(a, p->size);
    t->power = arena_doubles(a, p->size);
    t->steps = sky ? arena_doubles(a, 2 * p->stride) : NULL;
}

/* Return the factor of both halves and that of integrals over the plane. */
static double factor_of(const mode_plane *p, int s, int jy) {
    const double s2 = (double)s * s;
    const double norm = 1.0 / ((double)p->nx * p->ny * s2 * s2);
    return (jy > 0 ? 2.0 : 1.0) * norm;
}

void target_fill_pixel(target *t, const mode_plane *p, double beta, int s) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    t->map = frame_map_pixel;
    t->beta = beta;
    t->limit = p->k_limit;
    t->jx = p->max_jx;
    t->jy = p->max_jy;
    for (int jx = -p->max_jx; jx <= p->max_jx; jx++) {
        const size_t column = mode_plane_column(p, jx);
        for (int jy = 0; jy < (int)p->stride; jy++) {
            const double ky2 = jy <= p->max_jy ? (uy * jy) * (uy * jy) : INFINITY;
            const double k2 = (ux * jx) * (ux * jx) + ky2;
            t->q2[column + (size_t)jy] = k2;
            t->power[column + (size_t)jy] = factor_of(p, s, jy) * exp(-beta * beta * k2);
        }
    }
}

void target_limit(target *t, const mode_plane *p, double farthest) {
    t->limit = fmin(t->limit, farthest);
    t->jx = target_last_jx(t, p, t->limit, 0, p->max_jx);
    t->jy = target_last_jy(t, p, t->limit, p->max_jy);
}

double target_farthest(double beta, double threshold) {
    static const double nothing = 1e-15;
    const double least = nothing * threshold * 4.0 * exp(-2.0); /* 4 exp(-2): the maximum */
    double x = 1.0 - log(least);
    for (int i = 0; i < 20; i++)
        x = 2.0 * log(x) - log(least);
    return sqrt(x) / beta;
}

/* ---- a map of the galaxy's own ---- */

/* Fill column jx of |q|^2 and, from its neighbour nearer to 0, that of the target. As jx grows by
 * 1, a Gaussian is multiplied by `step`, and that by `bend`. */
SHEAR_SIMD static void fill_column(double qx2, double cross, double yy, double uy, size_t n,
                                   double bend, const double *from, double *step, double *q2,
                                   double *power) {
#pragma omp simd
    for (size_t jy = 0; jy < n; jy++) {
        const double ky = uy * (double)jy;
        q2[jy] = qx2 + ky * (cross + yy * ky);
        power[jy] = from[jy] * step[jy];
        step[jy] *= bend;
    }
}

/* Rows beyond the plane's last one belong to no circle. */
static void close_column(const mode_plane *p, size_t n, double *q2) {
    for (size_t jy = (size_t)p->max_jy + 1; jy < n; jy++)
        q2[jy] = INFINITY;
}

/* Fill column 0, and the first steps to its right and left. */
static void fill_middle(target *t, const mode_plane *p, int s, size_t n, double *right,
                        double *left) {
    const size_t middle = mode_plane_column(p, 0);
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    const double b2 = t->beta * t->beta;
    for (size_t jy = 0; jy < n; jy++) {
        const double ky = uy * (double)jy;
        const double lean = 2.0 * t->map.xy * ux * ky;
        t->q2[middle + jy] = t->map.yy * ky * ky;
        t->power[middle + jy] = factor_of(p, s, (int)jy) * exp(-b2 * t->map.yy * ky * ky);
        right[jy] = exp(-b2 * (t->map.xx * ux * ux + lean));
        left[jy] = exp(-b2 * (t->map.xx * ux * ux - lean));
    }
    close_column(p, n, t->q2 + middle);
}

void target_fill_sky(target *t, const mode_plane *p, const frame_map *map, double beta, int s,
                     double farthest) {
    t->map = *map;
    t->beta = beta;
    t->limit = p->k_limit / map->stretch;
    target_limit(t, p, farthest);
    const size_t n = fft_padded(t->jy + 1);
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    const double bend = exp(-2.0 * beta * beta * map->xx * ux * ux);
    double *right = t->steps;
    double *left = t->steps + p->stride;
    fill_middle(t, p, s, n, right, left);
    for (int jx = 1; jx <= t->jx; jx++) {
        const double kx = ux * jx;
        const double qx2 = map->xx * kx * kx;
        const double cross = 2.0 * map->xy * kx;
        const size_t up = mode_plane_column(p, jx);
        const size_t down = mode_plane_column(p, -jx);
        fill_column(qx2, cross, map->yy, uy, n, bend, t->power + up - p->stride, right, t->q2 + up,
                    t->power + up);
        fill_column(qx2, -cross, map->yy, uy, n, bend, t->power + down + p->stride, left,
                    t->q2 + down, t->power + down);
        close_column(p, n, t->q2 + up);
        close_column(p, n, t->q2 + down);
    }
}

/* ---- which modes lie inside a circle ---- */

static int last_mode(double k, int n, int most) {
    assert(k >= 0.0);
    const int j = (int)fmin(floor(k * n / (2.0 * M_PI)), most);
    return j < most ? j : most;
}

int target_last_jx(const target *t, const mode_plane *p, double q, int jy, int most) {
    return last_mode(frame_map_kx(&t->map, q, 2.0 * M_PI / p->ny * jy), p->nx, most);
}

int target_last_jy(const target *t, const mode_plane *p, double q, int most) {
    return last_mode(frame_map_ky(&t->map, q), p->ny, most);
}

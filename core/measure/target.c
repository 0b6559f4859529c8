/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/target.h"

#include <assert.h>

target_aim target_aim_at(const mode_plane *p, const frame_map *map, double beta, double farthest) {
    target_aim t = {.map = *map, .beta = beta, .limit = fmin(p->k_limit / map->stretch, farthest)};
    t.jx = target_last_jx(&t, p, t.limit, 0, p->max_jx);
    t.jy = target_last_jy(&t, p, t.limit, p->max_jy);
    return t;
}

static int last_mode(double k, int n, int most) {
    assert(k >= 0.0);
    const int j = (int)fmin(floor(k * n / (2.0 * M_PI)), most);
    return j < most ? j : most;
}

int target_last_jx(const target_aim *t, const mode_plane *p, double q, int jy, int most) {
    return last_mode(frame_map_kx(&t->map, q, 2.0 * M_PI / p->ny * jy), p->nx, most);
}

int target_last_jy(const target_aim *t, const mode_plane *p, double q, int most) {
    return last_mode(frame_map_ky(&t->map, q), p->ny, most);
}

double target_farthest(double beta, double threshold) {
    static const double nothing = 1e-15;
    const double least = nothing * threshold * 4.0 * exp(-2.0); /* 4 exp(-2): the maximum */
    double x = 1.0 - log(least);
    for (int i = 0; i < 20; i++)
        x = 2.0 * log(x) - log(least);
    return sqrt(x) / beta;
}

double target_factor(const mode_plane *p, int s, int jy) {
    const double s2 = (double)s * s;
    const double norm = 1.0 / ((double)p->nx * p->ny * s2 * s2);
    return (jy > 0 ? 2.0 : 1.0) * norm;
}

void target_place(target *t, const mode_plane *p, arena *a) {
    t->k2 = arena_doubles(a, p->size);
    t->power = arena_doubles(a, p->size);
}

void target_fill(target *t, const mode_plane *p, double beta, int s) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    t->aim = target_aim_at(p, &frame_map_pixel, beta, INFINITY);
    t->aim.jx = p->max_jx;
    t->aim.jy = p->max_jy;
    for (int jx = -p->max_jx; jx <= p->max_jx; jx++) {
        const size_t column = mode_plane_column(p, jx);
        for (int jy = 0; jy < (int)p->stride; jy++) {
            const double ky2 = jy <= p->max_jy ? (uy * jy) * (uy * jy) : INFINITY;
            const double k2 = (ux * jx) * (ux * jx) + ky2;
            t->k2[column + (size_t)jy] = k2;
            t->power[column + (size_t)jy] = target_factor(p, s, jy) * exp(-beta * beta * k2);
        }
    }
}

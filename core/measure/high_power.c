/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/high_power.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <assert.h>
#include <stdint.h>

enum { MODES = 2000 }; /* as many as 64 x 64 px have: a stamp's level to 3 % */

/* (2 jx/nx)^2 + (2 jy/ny)^2 >= (quarters/4)^2, in integers, so that rounding does not decide which
 * modes count. */
static bool beyond(int64_t jx, int64_t jy, int64_t nx, int64_t ny, int64_t quarters) {
    return 64 * (jx * jx * ny * ny + jy * jy * nx * nx) >= quarters * quarters * nx * nx * ny * ny;
}

/* Return the number of rows that count: jy < ny/2. */
static int rows_of(int ny) {
    return (ny + 1) / 2;
}

/* Enter mode (jx, jy) into the tables, and its group's first jx. Column jx = nx/2 is left out like
 * row jy = ny/2, so that a square stamp rotated by 90 degrees has the same power. */
static void count_mode(high_band *b, int x, int jy) {
    const int jx = x <= b->nx / 2 ? x : b->nx - x;
    if (2 * jx == b->nx)
        return;
    const double images = jy == 0 ? 1.0 : 2.0;
    const size_t at = (size_t)x * b->stride + (size_t)jy;
    int *first = &b->first_jx[jy / FFT_LANES];
    if (beyond(jx, jy, b->nx, b->ny, 4)) {
        b->corner[at] = images;
        b->n_corner += images;
    } else if (b->edge != NULL && beyond(jx, jy, b->nx, b->ny, 3)) {
        b->edge[at] = images;
        b->n_edge += images;
    } else {
        return;
    }
    *first = jx < *first ? jx : *first; // NOLINT(clang-analyzer-core.*): high_band_place sets it
}

static void count_group(high_band *b, int group) {
    const int first = group * FFT_LANES;
    const int end = first + FFT_LANES < rows_of(b->ny) ? first + FFT_LANES : rows_of(b->ny);
    for (int x = 0; x < b->nx; x++) {
        for (int jy = first; jy < end; jy++)
            count_mode(b, x, jy);
    }
}

void high_band_place(high_band *b, int nx, int ny, bool corners_only, arena *a) {
    const int rows = rows_of(ny);
    *b = (high_band){
        .nx = nx, .ny = ny, .last_group = (rows - 1) / FFT_LANES, .stride = fft_padded(rows)};
    b->first_jx = arena_take(a, ((size_t)b->last_group + 1) * sizeof *b->first_jx);
    b->corner = arena_doubles(a, (size_t)nx * b->stride);
    b->edge = corners_only ? NULL : arena_doubles(a, (size_t)nx * b->stride);
    if (a->memory == NULL)
        return;
    for (int group = 0; group <= b->last_group; group++)
        b->first_jx[group] = nx / 2 + 1;
    count_group(b, b->last_group);
    for (int group = 0; group < b->last_group && b->n_edge + b->n_corner < MODES; group++)
        count_group(b, group);
}

/* Running sums; lane l holds row l of the group. */
typedef struct lane_power {
    double edge_galaxy[FFT_LANES], edge_noise[FFT_LANES];
    double corner_galaxy[FFT_LANES], corner_noise[FFT_LANES];
} lane_power;

/* With z = g + i n: G(k) = (Z(k) + Z*(-k))/2 and N(k) = (Z(k) - Z*(-k))/2i. These are four times
 * their squares. The noise's power comes from N itself, not from a difference of sums: if it is
 * negligible beside the galaxy's, it comes out as negligible. */
static SHEAR_INLINE void add_column(lane_power *s, const mode_rows *r, size_t x, const double *edge,
                                    const double *corner) {
    const size_t at = x * FFT_LANES;
    const size_t mirror = ((size_t)r->nx - x) * FFT_LANES;
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++) {
        const mode z = mode_at(r, at + l, mirror + l);
        const double galaxy = (z.a + z.c) * (z.a + z.c) + (z.b - z.d) * (z.b - z.d);
        const double noise = (z.b + z.d) * (z.b + z.d) + (z.a - z.c) * (z.a - z.c);
        if (edge != NULL) {
            s->edge_galaxy[l] += edge[l] * galaxy;
            s->edge_noise[l] += edge[l] * noise;
        }
        s->corner_galaxy[l] += corner[l] * galaxy;
        s->corner_noise[l] += corner[l] * noise;
    }
}

SHEAR_SIMD static void sum_columns(const mode_rows *rows, const high_band *b, lane_power *out) {
    const mode_rows r = *rows;
    const size_t nx = (size_t)r.nx;
    const size_t first = (size_t)b->first_jx[r.group];
    const size_t last = first > 0 ? nx - first : nx - 1;
    const size_t row = (size_t)r.group * FFT_LANES;
    lane_power s = {0}; /* a local copy stays in registers */
    if (b->edge == NULL) {
        for (size_t x = first; x <= last; x++)
            add_column(&s, &r, x, NULL, b->corner + x * b->stride + row);
    } else {
        for (size_t x = first; x <= last; x++)
            add_column(&s, &r, x, b->edge + x * b->stride + row, b->corner + x * b->stride + row);
    }
    *out = s;
}

void high_power_add(high_power *p, const high_band *b, const mode_rows *rows) {
    assert(high_band_wants(b, rows->group));
    lane_power s;
    sum_columns(rows, b, &s);
    p->edge_galaxy += 0.25 * fft_total(s.edge_galaxy);
    p->edge_noise += 0.25 * fft_total(s.edge_noise);
    p->corner_galaxy += 0.25 * fft_total(s.corner_galaxy);
    p->corner_noise += 0.25 * fft_total(s.corner_noise);
}

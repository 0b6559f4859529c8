/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/filter.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double zero_below = 1e-16; /* below the rounding of what it multiplies */
static const double edge_value = 1e-3;

/* Return the distance in pixels of fine point `fine` from the centre of n pixels, along one axis of
 * the periodic grid. */
static double from_centre(int fine, int n, int s) {
    const double d = (double)fine / s - 0.5 * (n - 1);
    return d > 0.5 * n ? d - n : d;
}

static int strips(const filter_map *m) {
    return (m->nx * m->s + FFT_LANES - 1) / FFT_LANES;
}

void filter_map_place(filter_map *m, int nx, int ny, int s, arena *a) {
    const size_t rows = (size_t)ny * (size_t)s;
    *m = (filter_map){.nx = nx, .ny = ny, .s = s, .core_px = NAN, .width_px = NAN};
    m->value = arena_doubles(a, rows * (size_t)nx * (size_t)s);
    m->x0 = arena_take(a, rows * sizeof *m->x0);
    m->x1 = arena_take(a, rows * sizeof *m->x1);
    m->dx2 = arena_doubles(a, fft_padded(nx * s));
    m->row = arena_doubles(a, fft_padded(nx * s));
    m->strip_y0 = arena_take(a, (size_t)strips(m) * sizeof *m->strip_y0);
    m->strip_y1 = arena_take(a, (size_t)strips(m) * sizeof *m->strip_y1);
    for (int i = 0; a->memory != NULL && i < (int)fft_padded(nx * s); i++) {
        const double dx = from_centre(i < nx * s ? i : 0, nx, s);
        m->dx2[i] = dx * dx;
    }
}

/* Compute the row at dy^2 from the centre, `padded` points of it: whole vectors, so that points at
 * the same distance have the same value to the last bit. Beyond 37 widths the value is zero, and
 * exp would underflow, which is slow. */
SHEAR_SIMD static void window(const double *dx2, double dy2, double core, double per_width,
                              size_t padded, double *out) {
#pragma omp simd
    for (size_t i = 0; i < padded; i++) {
        const double x = (sqrt(dx2[i] + dy2) - core) * per_width;
        const double beyond = x > 0.0 ? x : 0.0;
        out[i] = beyond < 37.0 ? beyond : 37.0;
    }
#pragma omp simd simdlen(8)
    for (size_t i = 0; i < padded; i++) {
        const double v = exp(-0.5 * out[i] * out[i]);
        out[i] = v < zero_below ? 0.0 : v;
    }
}

/* Fill row `fine_y`. Return whether any of it is not zero. */
static bool fill_row(filter_map *m, int fine_y) {
    const int n = m->nx * m->s;
    const double dy = from_centre(fine_y, m->ny, m->s);
    double *row = m->value + (size_t)fine_y * (size_t)n;
    int first = 0;
    int last = n - 1;
    window(m->dx2, dy * dy, m->core_px, 1.0 / m->width_px, fft_padded(n), m->row);
    memcpy(row, m->row, (size_t)n * sizeof *row);
    while (last >= 0 && row[last] == 0.0)
        last--;
    while (first < last && row[first] == 0.0)
        first++;
    m->x0[fine_y] = first;
    m->x1[fine_y] = last + 1;
    return last >= 0;
}

/* Return the row at the same distance on the other side of the centre. */
static int mirrored(const filter_map *m, int fine_y) {
    const int n = m->ny * m->s;
    return ((m->ny - 1) * m->s - fine_y + n) % n;
}

static bool copy_row(filter_map *m, int from, int to) {
    const size_t n = (size_t)m->nx * (size_t)m->s;
    memcpy(m->value + (size_t)to * n, m->value + (size_t)from * n, n * sizeof *m->value);
    m->x0[to] = m->x0[from];
    m->x1[to] = m->x1[from];
    return m->x1[to] > m->x0[to];
}

/* Find the rows of a strip that are not all zero. */
static void bound_strip(filter_map *m, int strip) {
    const int end = m->nx * m->s;
    const int from = strip * FFT_LANES < end - FFT_LANES ? strip * FFT_LANES : end - FFT_LANES;
    int y0 = m->y1;
    int y1 = m->y0;
    for (int y = m->y0; y < m->y1; y++) {
        if (m->x0[y] < from + FFT_LANES && m->x1[y] > from) {
            y0 = y < y0 ? y : y0;
            y1 = y + 1;
        }
    }
    m->strip_y0[strip] = y0 < y1 ? y0 : 0;
    m->strip_y1[strip] = y0 < y1 ? y1 : 0;
}

static double sum_of(const double *values, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += values[i];
    return sum;
}

void filter_map_fill(filter_map *m, double core_px, double width_px) {
    assert(core_px >= 0.0 && width_px > 0.0);
    if (m->core_px == core_px && m->width_px == width_px)
        return;
    m->core_px = core_px;
    m->width_px = width_px;
    m->y0 = m->ny * m->s;
    m->y1 = 0;
    for (int y = 0; y < m->ny * m->s; y++) {
        if (mirrored(m, y) < y ? copy_row(m, mirrored(m, y), y) : fill_row(m, y)) {
            m->y0 = y < m->y0 ? y : m->y0;
            m->y1 = y + 1;
        }
    }
    for (int i = 0; i < strips(m); i++)
        bound_strip(m, i);
    m->sum = sum_of(m->value, (size_t)m->nx * (size_t)m->s * (size_t)m->ny * (size_t)m->s);
}

void filter_pair_place(filter_pair *f, int nx, int ny, int s, arena *a) {
    filter_map_place(&f->fine, nx, ny, s, a);
    if (s > 1)
        filter_map_place(&f->coarse, nx, ny, 1, a);
}

void filter_pair_fill(filter_pair *f, double core_px, double width_px) {
    filter_map_fill(&f->fine, core_px, width_px);
    if (f->fine.s > 1)
        filter_map_fill(&f->coarse, core_px, width_px);
}

const filter_map *filter_pair_pixels(const filter_pair *f) {
    return f->fine.s > 1 ? &f->coarse : &f->fine;
}

double filter_edge_core(int nx, int ny, double width_px) {
    const double edge = 0.5 * ((nx < ny ? nx : ny) - 1);
    return edge - width_px * sqrt(-2.0 * log(edge_value));
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/surface.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* The value that replaces a zero under zeros=floor, in units of the image's brightest pixel, so
 * that the result scales with the flux. */
static const double floor_of_peak = 1e-12;

static enum axis_kind axis_kind_of(enum shear_interpolation interpolation) {
    switch (interpolation) {
    case SHEAR_INTERP_BILINEAR:
    case SHEAR_INTERP_LOG_BILINEAR:
        return AXIS_LINEAR;
    case SHEAR_INTERP_BICUBIC:
    case SHEAR_INTERP_LOG_BICUBIC:
        return AXIS_CUBIC;
    case SHEAR_INTERP_SPLINE:
    case SHEAR_INTERP_LOG_SPLINE:
        return AXIS_SPLINE;
    default:
        return AXIS_NONE;
    }
}

void surface_grid_place(surface_grid *g, int nx, int ny, enum shear_interpolation interpolation,
                        int s, enum shear_zeros zeros, double pedestal, arena *a) {
    const enum axis_kind kind = axis_kind_of(interpolation);
    *g = (surface_grid){.log = shear_interpolation_is_log(interpolation),
                        .zeros = zeros,
                        .pedestal = pedestal,
                        .fine_nx = nx * s,
                        .fine_ny = ny * s,
                        .wide = fft_padded(nx),
                        .high = fft_padded(ny)};
    axis_place(&g->x, kind, nx, s, a);
    axis_place(&g->y, kind, ny, s, a);
}

/* The arrays begin as zeros: slopes stay zero under the linear methods, and the padding always. */
void surface_place(surface *s, const surface_grid *g, arena *a) {
    *s = (surface){0};
    if (g->x.kind == AXIS_NONE)
        return;
    const size_t n = g->wide * g->high;
    s->rows = arena_doubles(a, n);
    s->row_slopes = arena_doubles(a, n);
    s->f = arena_doubles(a, n);
    s->fx = arena_doubles(a, n);
    s->fy = arena_doubles(a, n);
    s->fxy = arena_doubles(a, n);
    s->strip_f = arena_doubles(a, g->high * FFT_LANES);
    s->strip_fy = arena_doubles(a, g->high * FFT_LANES);
}

SHEAR_SIMD static void extremes(const double *pixels, size_t n, double *low, double *high) {
    double least = INFINITY;
    double most = -INFINITY;
#pragma omp simd reduction(min : least) reduction(max : most)
    for (size_t i = 0; i < n; i++) {
        least = pixels[i] < least ? pixels[i] : least;
        most = pixels[i] > most ? pixels[i] : most;
    }
    *low = least;
    *high = most;
}

/* Take ln of a row of pixels. Zeros become marks (ln 0) or, under zeros=floor, the logarithm of
 * `tiny`. */
SHEAR_SIMD static void log_row(const double *pixels, size_t n, double pedestal, double tiny,
                               double *out) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double value = pixels[i] + pedestal;
        out[i] = log(value > tiny ? value : tiny);
    }
}

/* Find the first pixel that is below the limit. */
static void find_negative(const surface_grid *g, const double *pixels, double limit, int *bad_x,
                          int *bad_y) {
    int i = 0;
    while (!(pixels[i] + g->pedestal < limit))
        i++;
    *bad_x = i % g->x.n;
    *bad_y = i / g->x.n;
}

/* Load the values to be interpolated: pixels, or their logarithms. */
static void load_rows(surface *s, const surface_grid *g, double tiny) {
    const size_t nx = (size_t)g->x.n;
    for (size_t j = 0; j < (size_t)g->y.n; j++) {
        if (g->log) {
            log_row(s->pixels + j * nx, nx, g->pedestal, tiny, s->rows + j * g->wide);
        } else {
            memcpy(s->rows + j * g->wide, s->pixels + j * nx, nx * sizeof *s->rows);
        }
    }
}

/* out[wide][high] = in[high][wide], transposed. */
static void transpose(const surface_grid *g, const double *in, double *out) {
    for (size_t y = 0; y < g->high; y += FFT_LANES) {
        for (size_t x = 0; x < g->wide; x += FFT_LANES) {
            double block[FFT_LANES * FFT_LANES];
            fft_transpose(in + y * g->wide + x, (ptrdiff_t)g->wide, block);
            for (size_t c = 0; c < FFT_LANES; c++)
                memcpy(out + (x + c) * g->high + y, block + c * FFT_LANES, FFT_LANES * sizeof *out);
        }
    }
}

/* Compute slopes along y with columns as lanes, along x with rows as lanes. */
static void load_slopes(surface *s, const surface_grid *g) {
    axis_slopes(&g->y, s->rows, s->row_slopes, g->wide, (int)g->wide);
    transpose(g, s->rows, s->f);
    transpose(g, s->row_slopes, s->fy);
    axis_slopes(&g->x, s->f, s->fx, g->high, (int)g->high);
    axis_slopes(&g->x, s->fy, s->fxy, g->high, (int)g->high);
}

/* Compute the slopes of all lines in one direction, of transposed arrays. */
static void mark_slopes(const surface_grid *g, const double *marks, const double *f, double *e,
                        bool along_x) {
    const int lines = along_x ? g->y.n : g->x.n;
    for (int i = 0; i < lines; i++) {
        const size_t at = (size_t)i * (along_x ? 1u : g->high);
        axis_slopes_marked(along_x ? &g->x : &g->y, marks + at, f + at, e + at,
                           along_x ? g->high : 1u);
    }
}

/* Next to marks the two directions do not commute: slopes along x first would give another surface
 * than along y first, and imprint a shape. Therefore the mixed slope is the mean of both orders. */
static void load_marked_slopes(surface *s, const surface_grid *g) {
    const size_t n = g->wide * g->high;
    double *other = s->row_slopes;
    transpose(g, s->rows, s->f);
    mark_slopes(g, s->f, s->f, s->fx, true);
    mark_slopes(g, s->f, s->f, s->fy, false);
    mark_slopes(g, s->f, s->fx, s->fxy, false);
    mark_slopes(g, s->f, s->fy, other, true);
    for (size_t i = 0; i < n; i++)
        s->fxy[i] = 0.5 * (s->fxy[i] + other[i]);
}

bool surface_load(surface *s, const surface_grid *g, const double *pixels, int *bad_x, int *bad_y) {
    s->pixels = pixels;
    if (g->x.kind == AXIS_NONE)
        return true;
    double tiny = 0.0;
    s->marked = false;
    if (g->log) {
        double low;
        double high;
        extremes(pixels, (size_t)g->x.n * (size_t)g->y.n, &low, &high);
        const double limit = g->rounding > 0.0 ? -g->rounding * (high + g->pedestal) : 0.0;
        if (low + g->pedestal < limit) {
            find_negative(g, pixels, limit, bad_x, bad_y);
            return false;
        }
        const bool has_zeros = low + g->pedestal <= 0.0;
        s->marked = has_zeros && (g->zeros == SHEAR_ZEROS_SKIP || high + g->pedestal == 0.0);
        tiny = has_zeros ? floor_of_peak * (high + g->pedestal) : 0.0;
    }
    load_rows(s, g, s->marked ? 0.0 : tiny);
    if (s->marked) {
        load_marked_slopes(s, g);
    } else {
        load_slopes(s, g);
    }
    return true;
}

/* Mix values at a fine column, for all rows, or at a fine row, for all columns of a strip: f = a
 * f_left + b f_right + c e_left + d e_right. */
static SHEAR_INLINE void mix(axis_weights w, const double *f_left, const double *f_right,
                             const double *e_left, const double *e_right, size_t n, double *out) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        out[i] = w.a * f_left[i] + w.b * f_right[i] + w.c * e_left[i] + w.d * e_right[i];
}

/* Interpolate a strip along x: from [x][y] to [y][FFT_LANES], FFT_LANES rows at a time. */
SHEAR_SIMD static void mix_columns(const axis_point *x, const double *f, const double *e,
                                   size_t high, double *out) {
    for (size_t y = 0; y < high; y += FFT_LANES) {
        double block[FFT_LANES * FFT_LANES];
        for (size_t c = 0; c < FFT_LANES; c++) {
            const size_t left = (size_t)x[c].left * high + y;
            const size_t right = (size_t)x[c].right * high + y;
            mix(x[c].w, f + left, f + right, e + left, e + right, FFT_LANES, block + c * FFT_LANES);
        }
        fft_transpose(block, FFT_LANES, out + y * FFT_LANES);
    }
}

SHEAR_SIMD static void mix_rows(const axis_point *y, int y0, int y1, const double *f,
                                const double *e, double *out) {
    for (int i = y0; i < y1; i++) {
        const size_t left = (size_t)y[i].left * FFT_LANES;
        const size_t right = (size_t)y[i].right * FFT_LANES;
        mix(y[i].w, f + left, f + right, e + left, e + right, FFT_LANES,
            out + (size_t)i * FFT_LANES);
    }
}

/* Interpolate values and slopes along x in an image with marks. */
static void mix_marked_columns(surface *s, const surface_grid *g, const axis_point *x) {
    for (size_t y = 0; y < (size_t)g->y.n; y++) {
        for (size_t c = 0; c < FFT_LANES; c++) {
            const size_t left = (size_t)x[c].left * g->high + y;
            const size_t right = (size_t)x[c].right * g->high + y;
            const axis_weights w = x[c].w;
            s->strip_f[y * FFT_LANES + c] =
                axis_between_marks(&x[c], s->f[left], s->f[right], s->fx[left], s->fx[right]);
            s->strip_fy[y * FFT_LANES + c] =
                w.a * s->fy[left] + w.b * s->fy[right] + w.c * s->fxy[left] + w.d * s->fxy[right];
        }
    }
}

static void mix_marked_rows(const surface *s, const axis_point *y, int y0, int y1, double *out) {
    for (int i = y0; i < y1; i++) {
        for (size_t c = 0; c < FFT_LANES; c++) {
            const size_t left = (size_t)y[i].left * FFT_LANES + c;
            const size_t right = (size_t)y[i].right * FFT_LANES + c;
            out[(size_t)i * FFT_LANES + c] = axis_between_marks(
                &y[i], s->strip_f[left], s->strip_f[right], s->strip_fy[left], s->strip_fy[right]);
        }
    }
}

SHEAR_SIMD static void undo_log(double *values, size_t n, double pedestal) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        values[i] = exp(values[i]) - pedestal;
}

static void copy_columns(const surface *s, const surface_grid *g, int x0, int y0, int y1,
                         double *out) {
    const int n = x0 + FFT_LANES <= g->fine_nx ? FFT_LANES : g->fine_nx - x0;
    for (int y = y0; y < y1; y++) {
        memcpy(out + (size_t)y * FFT_LANES, s->pixels + (size_t)y * (size_t)g->fine_nx + x0,
               (size_t)n * sizeof *out);
    }
}

void surface_strip(surface *s, const surface_grid *g, int x0, int y0, int y1, double *out) {
    assert(x0 >= 0 && x0 < g->fine_nx && y0 >= 0 && y0 <= y1 && y1 <= g->fine_ny);
    const axis_point *x = g->x.points + x0;
    const axis_point *y = g->y.points;
    if (g->x.kind == AXIS_NONE) {
        copy_columns(s, g, x0, y0, y1, out);
        return;
    }
    if (s->marked) {
        mix_marked_columns(s, g, x);
        mix_marked_rows(s, y, y0, y1, out);
    } else {
        mix_columns(x, s->f, s->fx, g->high, s->strip_f);
        mix_columns(x, s->fy, s->fxy, g->high, s->strip_fy);
        mix_rows(y, y0, y1, s->strip_f, s->strip_fy, out);
    }
    if (g->log)
        undo_log(out + (size_t)y0 * FFT_LANES, (size_t)(y1 - y0) * FFT_LANES, g->pedestal);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/surface.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <math.h>
#include <string.h>

/* What zeros=floor puts for a zero, in units of the image's brightest pixel: relative, so that the
 * result scales with the flux. */
static const double floor_of_peak = 1e-12;

static int axis_kind_of(enum shear_interpolation interpolation) {
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

bool image_grid_init(image_grid *g, int nx, int ny, enum shear_interpolation interpolation, int s,
                     enum shear_zeros zeros, double pedestal) {
    const int kind = axis_kind_of(interpolation);
    *g = (image_grid){.log = shear_interpolation_is_log(interpolation),
                      .zeros = zeros,
                      .pedestal = pedestal,
                      .fine_nx = nx * s,
                      .fine_ny = ny * s,
                      .wide = fft_padded(nx),
                      .high = fft_padded(ny)};
    const bool x_made = axis_init(&g->x, kind, nx, s);
    const bool y_made = axis_init(&g->y, kind, ny, s);
    return x_made && y_made;
}

void image_grid_deinit(image_grid *g) {
    axis_deinit(&g->x);
    axis_deinit(&g->y);
}

/* Slopes stay zero under the linear methods, and what is beyond the pixels always. */
static double *new_zeros(size_t n) {
    double *made = fft_alloc(n * sizeof *made);
    return made != NULL ? memset(made, 0, n * sizeof *made) : NULL;
}

bool image_init(image *im, const image_grid *g) {
    *im = (image){0};
    if (g->x.kind == AXIS_NONE) {
        return true;
    }
    const size_t n = g->wide * g->high;
    im->rows = new_zeros(n);
    im->row_slopes = new_zeros(n);
    im->f = new_zeros(n);
    im->fx = new_zeros(n);
    im->fy = new_zeros(n);
    im->fxy = new_zeros(n);
    im->strip_f = new_zeros(g->high * FFT_LANES);
    im->strip_fy = new_zeros(g->high * FFT_LANES);
    return im->rows != NULL && im->row_slopes != NULL && im->f != NULL && im->fx != NULL &&
           im->fy != NULL && im->fxy != NULL && im->strip_f != NULL && im->strip_fy != NULL;
}

void image_deinit(image *im) {
    fft_free(im->rows);
    fft_free(im->row_slopes);
    fft_free(im->f);
    fft_free(im->fx);
    fft_free(im->fy);
    fft_free(im->fxy);
    fft_free(im->strip_f);
    fft_free(im->strip_fy);
    *im = (image){0};
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

/* ln of a row of pixels. Zeros become marks (ln 0) or, under zeros=floor, the logarithm of `tiny`.
 */
SHEAR_SIMD static void take_log(const double *pixels, size_t n, double pedestal, double tiny,
                                double *out) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double value = pixels[i] + pedestal;
        out[i] = log(value > tiny ? value : tiny);
    }
}

/* The first pixel that is below the limit. */
static void find_negative(const image_grid *g, const double *pixels, double limit, int *bad_x,
                          int *bad_y) {
    int i = 0;
    while (!(pixels[i] + g->pedestal < limit)) {
        i++;
    }
    *bad_x = i % g->x.n;
    *bad_y = i / g->x.n;
}

/* The values to be interpolated: pixels, or their logarithms. */
static void load_rows(image *im, const image_grid *g, double tiny) {
    const size_t nx = (size_t)g->x.n;
    for (size_t j = 0; j < (size_t)g->y.n; j++) {
        if (g->log) {
            take_log(im->pixels + j * nx, nx, g->pedestal, tiny, im->rows + j * g->wide);
        } else {
            memcpy(im->rows + j * g->wide, im->pixels + j * nx, nx * sizeof *im->rows);
        }
    }
}

/* out[wide][high] = in[high][wide], turned. */
static void turn(const image_grid *g, const double *in, double *out) {
    for (size_t y = 0; y < g->high; y += FFT_LANES) {
        for (size_t x = 0; x < g->wide; x += FFT_LANES) {
            double block[FFT_LANES * FFT_LANES];
            fft_turn(in + y * g->wide + x, (ptrdiff_t)g->wide, block);
            for (size_t c = 0; c < FFT_LANES; c++) {
                memcpy(out + (x + c) * g->high + y, block + c * FFT_LANES, FFT_LANES * sizeof *out);
            }
        }
    }
}

/* Slopes along y with the columns for lanes, along x with the rows for lanes. */
static void load_slopes(image *im, const image_grid *g) {
    axis_slopes(&g->y, im->rows, im->row_slopes, g->wide, (int)g->wide);
    turn(g, im->rows, im->f);
    turn(g, im->row_slopes, im->fy);
    axis_slopes(&g->x, im->f, im->fx, g->high, (int)g->high);
    axis_slopes(&g->x, im->fy, im->fxy, g->high, (int)g->high);
}

/* All lines of one direction, of turned arrays. */
static void mark_slopes(const image_grid *g, const double *marks, const double *f, double *e,
                        bool along_x) {
    const int lines = along_x ? g->y.n : g->x.n;
    for (int i = 0; i < lines; i++) {
        const size_t at = (size_t)i * (along_x ? 1u : g->high);
        axis_slopes_marked(along_x ? &g->x : &g->y, marks + at, f + at, e + at,
                           along_x ? g->high : 1u);
    }
}

/* Beside marks the two directions do not commute: along x first would be another surface than along
 * y first, and imprint a shape. So the mixed slope is the mean of both orders. */
static void load_marked_slopes(image *im, const image_grid *g) {
    const size_t n = g->wide * g->high;
    double *other = im->row_slopes;
    turn(g, im->rows, im->f);
    mark_slopes(g, im->f, im->f, im->fx, true);
    mark_slopes(g, im->f, im->f, im->fy, false);
    mark_slopes(g, im->f, im->fx, im->fxy, false);
    mark_slopes(g, im->f, im->fy, other, true);
    for (size_t i = 0; i < n; i++) {
        im->fxy[i] = 0.5 * (im->fxy[i] + other[i]);
    }
}

bool image_load(image *im, const image_grid *g, const double *pixels, int *bad_x, int *bad_y) {
    im->pixels = pixels;
    if (g->x.kind == AXIS_NONE) {
        return true;
    }
    double tiny = 0.0;
    im->marked = false;
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
        im->marked = has_zeros && (g->zeros == SHEAR_ZEROS_SKIP || high + g->pedestal == 0.0);
        tiny = has_zeros ? floor_of_peak * (high + g->pedestal) : 0.0;
    }
    load_rows(im, g, im->marked ? 0.0 : tiny);
    if (im->marked) {
        load_marked_slopes(im, g);
    } else {
        load_slopes(im, g);
    }
    return true;
}

/* Values at a fine column, all rows, and at a fine row, all columns of a strip: f = a f_left + b
 * f_right + c e_left + d e_right. */
static SHEAR_INLINE void mix(axis_weights w, const double *f_left, const double *f_right,
                             const double *e_left, const double *e_right, size_t n, double *out) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        out[i] = w.a * f_left[i] + w.b * f_right[i] + w.c * e_left[i] + w.d * e_right[i];
    }
}

/* A strip along x: from [x][y] to [y][FFT_LANES], FFT_LANES rows at a time. */
SHEAR_SIMD static void mix_columns(const axis_point *x, const double *f, const double *e,
                                   size_t high, double *out) {
    for (size_t y = 0; y < high; y += FFT_LANES) {
        double block[FFT_LANES * FFT_LANES];
        for (size_t c = 0; c < FFT_LANES; c++) {
            const size_t left = (size_t)x[c].left * high + y;
            const size_t right = (size_t)x[c].right * high + y;
            mix(x[c].w, f + left, f + right, e + left, e + right, FFT_LANES, block + c * FFT_LANES);
        }
        fft_turn(block, FFT_LANES, out + y * FFT_LANES);
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

/* Both, where there are marks. */
static void mix_marked_columns(image *im, const image_grid *g, const axis_point *x) {
    for (size_t y = 0; y < (size_t)g->y.n; y++) {
        for (size_t c = 0; c < FFT_LANES; c++) {
            const size_t left = (size_t)x[c].left * g->high + y;
            const size_t right = (size_t)x[c].right * g->high + y;
            const axis_weights w = x[c].w;
            im->strip_f[y * FFT_LANES + c] =
                axis_between_marks(&x[c], im->f[left], im->f[right], im->fx[left], im->fx[right]);
            im->strip_fy[y * FFT_LANES + c] = w.a * im->fy[left] + w.b * im->fy[right] +
                                              w.c * im->fxy[left] + w.d * im->fxy[right];
        }
    }
}

static void mix_marked_rows(const image *im, const axis_point *y, int y0, int y1, double *out) {
    for (int i = y0; i < y1; i++) {
        for (size_t c = 0; c < FFT_LANES; c++) {
            const size_t left = (size_t)y[i].left * FFT_LANES + c;
            const size_t right = (size_t)y[i].right * FFT_LANES + c;
            out[(size_t)i * FFT_LANES + c] =
                axis_between_marks(&y[i], im->strip_f[left], im->strip_f[right], im->strip_fy[left],
                                   im->strip_fy[right]);
        }
    }
}

SHEAR_SIMD static void undo_log(double *values, size_t n, double pedestal) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        values[i] = exp(values[i]) - pedestal;
    }
}

static void copy_columns(const image *im, const image_grid *g, int x0, int y0, int y1,
                         double *out) {
    const int n = x0 + FFT_LANES <= g->fine_nx ? FFT_LANES : g->fine_nx - x0;
    for (int y = y0; y < y1; y++) {
        memcpy(out + (size_t)y * FFT_LANES, im->pixels + (size_t)y * (size_t)g->fine_nx + x0,
               (size_t)n * sizeof *out);
    }
}

void image_strip(image *im, const image_grid *g, int x0, int y0, int y1, double *out) {
    const axis_point *x = g->x.points + x0;
    const axis_point *y = g->y.points;
    if (g->x.kind == AXIS_NONE) {
        copy_columns(im, g, x0, y0, y1, out);
        return;
    }
    if (im->marked) {
        mix_marked_columns(im, g, x);
        mix_marked_rows(im, y, y0, y1, out);
    } else {
        mix_columns(x, im->f, im->fx, g->high, im->strip_f);
        mix_columns(x, im->fy, im->fxy, g->high, im->strip_fy);
        mix_rows(y, y0, y1, im->strip_f, im->strip_fy, out);
    }
    if (g->log) {
        undo_log(out + (size_t)y0 * FFT_LANES, (size_t)(y1 - y0) * FFT_LANES, g->pedestal);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/image.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <math.h>
#include <string.h>

/* What zeros=floor puts for a zero, in units of the image's brightest pixel: relative, so that the
 * result scales with the flux. */
static const double floor_of_peak = 1e-12;

static int axis_kind_of(int interpolation) {
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

/* What a marked image needs at each pixel: the value, the slopes along x and y, the mixed one, and
 * room for its second half. A smooth one needs its slopes along y, logarithms, and a turned image
 * with its slopes. */
enum { SURFACE_PARTS = 5 };

bool image_grid_init(image_grid *g, int nx, int ny, int interpolation, int s, int zeros,
                     double pedestal) {
    const int kind = axis_kind_of(interpolation);
    *g = (image_grid){.log = shear_interpolation_is_log(interpolation),
                      .zeros = zeros,
                      .pedestal = pedestal,
                      .fine_nx = nx * s,
                      .fine_ny = ny * s};
    g->stride = fft_row_stride(g->fine_nx);
    const bool x_made = axis_init(&g->x, kind, nx, s);
    const bool y_made = axis_init(&g->y, kind, ny, s);
    return x_made && y_made;
}

void image_grid_deinit(image_grid *g) {
    axis_deinit(&g->x);
    axis_deinit(&g->y);
}

bool image_init(image *im, const image_grid *g) {
    *im = (image){0};
    if (g->x.kind == AXIS_NONE) {
        return true;
    }
    const size_t numbers = (size_t)g->y.n * g->stride;
    im->f = fft_alloc(numbers * sizeof *im->f);
    im->e = fft_alloc(numbers * sizeof *im->e);
    im->surface = fft_alloc(SURFACE_PARTS * (size_t)g->x.n * (size_t)g->y.n * sizeof *im->surface);
    return im->f != NULL && im->e != NULL && im->surface != NULL;
}

void image_deinit(image *im) {
    fft_free(im->f);
    fft_free(im->e);
    fft_free(im->surface);
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

static void find_negative(const image_grid *g, const double *pixels, int *bad_x, int *bad_y) {
    int i = 0;
    while (!(pixels[i] + g->pedestal < 0.0)) {
        i++;
    }
    *bad_x = i % g->x.n;
    *bad_y = i / g->x.n;
}

/* [ny][nx] to [nx][ny]. */
static void transpose(const double *in, int nx, int ny, double *out) {
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            out[(size_t)x * (size_t)ny + (size_t)y] = in[(size_t)y * (size_t)nx + (size_t)x];
        }
    }
}

/* All rows of values, or of slopes along y, to rows that are fine along x. The slopes along x are
 * taken of all rows at once, which lie side by side in the transposed image. */
static void expand_rows(image *im, const image_grid *g, const double *values, double *out) {
    const int nx = g->x.n;
    const int ny = g->y.n;
    const size_t n = (size_t)nx * (size_t)ny;
    double *turned = im->surface + 2 * n;
    double *slopes = turned + n;
    if (g->x.kind != AXIS_LINEAR) {
        transpose(values, nx, ny, turned);
        axis_slopes(&g->x, turned, slopes, (size_t)ny, ny);
    }
    for (int j = 0; j < ny; j++) {
        axis_expand(&g->x, values + (size_t)j * (size_t)nx, slopes + j, (size_t)ny, false,
                    out + (size_t)j * g->stride);
    }
}

/* The slopes along y are taken at the pixels and then made fine along x, as the values are: both
 * interpolations are linear in what they interpolate, so that their order is free, and there are s
 * times fewer pixels than fine columns. */
static void load_smooth(image *im, const image_grid *g, const double *values) {
    double *slopes = im->surface;
    expand_rows(im, g, values, im->f);
    if (g->y.kind != AXIS_LINEAR) {
        axis_slopes(&g->y, values, slopes, (size_t)g->x.n, g->x.n);
        expand_rows(im, g, slopes, im->e);
    }
}

/* All lines of one direction: along x for step 1, along y for step nx. */
static void mark_slopes(const image_grid *g, const double *marks, const double *f, double *e,
                        bool along_x) {
    const size_t nx = (size_t)g->x.n;
    const int lines = along_x ? g->y.n : g->x.n;
    for (int i = 0; i < lines; i++) {
        const size_t at = (size_t)i * (along_x ? nx : 1u);
        axis_slopes_marked(along_x ? &g->x : &g->y, marks + at, f + at, e + at, along_x ? 1u : nx);
    }
}

/* Beside marks the two directions do not commute: fine rows first, then columns, would be another
 * surface than columns first, and imprint a shape. So all slopes are fixed at the pixels, and the
 * mixed one is the mean of both orders. */
static void load_marked(image *im, const image_grid *g, const double *pixels) {
    const size_t n = (size_t)g->x.n * (size_t)g->y.n;
    double *f = im->surface;
    double *fx = f + n;
    double *fy = fx + n;
    double *mixed = fy + n;
    double *other = mixed + n;
    take_log(pixels, n, g->pedestal, 0.0, f);
    mark_slopes(g, f, f, fx, true);
    mark_slopes(g, f, f, fy, false);
    mark_slopes(g, f, fx, mixed, false);
    mark_slopes(g, f, fy, other, true);
    for (size_t i = 0; i < n; i++) {
        mixed[i] = 0.5 * (mixed[i] + other[i]);
    }
    for (int j = 0; j < g->y.n; j++) {
        const size_t row = (size_t)j * (size_t)g->x.n;
        axis_expand(&g->x, f + row, fx + row, 1, true, im->f + (size_t)j * g->stride);
        axis_expand(&g->x, fy + row, mixed + row, 1, false, im->e + (size_t)j * g->stride);
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
        if (low + g->pedestal < 0.0) {
            find_negative(g, pixels, bad_x, bad_y);
            return false;
        }
        const bool has_zeros = low + g->pedestal == 0.0;
        im->marked = has_zeros && (g->zeros == SHEAR_ZEROS_SKIP || high + g->pedestal == 0.0);
        tiny = has_zeros ? floor_of_peak * (high + g->pedestal) : 0.0;
    }
    if (im->marked) {
        load_marked(im, g, pixels);
        return true;
    }
    const double *values = pixels;
    if (g->log) {
        double *logs = im->surface + (size_t)g->x.n * (size_t)g->y.n;
        take_log(pixels, (size_t)g->x.n * (size_t)g->y.n, g->pedestal, tiny, logs);
        values = logs;
    }
    load_smooth(im, g, values);
    return true;
}

SHEAR_SIMD static void mix_two(axis_weights w, const double *fj, const double *fk, int n,
                               double *out) {
#pragma omp simd
    for (int i = 0; i < n; i++) {
        out[i] = w.a * fj[i] + w.b * fk[i];
    }
}

SHEAR_SIMD static void mix_four(axis_weights w, const double *fj, const double *fk,
                                const double *ej, const double *ek, int n, double *out) {
#pragma omp simd
    for (int i = 0; i < n; i++) {
        out[i] = w.a * fj[i] + w.b * fk[i] + w.c * ej[i] + w.d * ek[i];
    }
}

static void combine(const image *im, const image_grid *g, int fine_y, int x0, int x1, double *out) {
    int j;
    int k;
    const axis_weights w = axis_at(&g->y, fine_y, &j, &k);
    const double *fj = im->f + (size_t)j * g->stride + x0;
    const double *fk = im->f + (size_t)k * g->stride + x0;
    const double *ej = im->e + (size_t)j * g->stride + x0;
    const double *ek = im->e + (size_t)k * g->stride + x0;
    const int n = x1 - x0;
    if (im->marked) {
        const bool on_grid = fine_y % g->y.s == 0;
        for (int i = 0; i < n; i++) {
            if (on_grid || fj[i] == -INFINITY || fk[i] == -INFINITY) {
                out[i] = on_grid ? fj[i] : -INFINITY;
            } else {
                out[i] = w.a * fj[i] + w.b * fk[i] + w.c * ej[i] + w.d * ek[i];
            }
        }
    } else if (g->y.kind == AXIS_LINEAR) {
        mix_two(w, fj, fk, n, out);
    } else {
        mix_four(w, fj, fk, ej, ek, n, out);
    }
}

SHEAR_SIMD static void undo_log(double *values, int n, double pedestal) {
#pragma omp simd
    for (int i = 0; i < n; i++) {
        values[i] = exp(values[i]) - pedestal;
    }
}

bool image_is_smooth_log(const image *im, const image_grid *g) {
    return g->log && !im->marked && g->y.kind != AXIS_LINEAR;
}

log_row image_log_row(const image *im, const image_grid *g, int fine_y) {
    int j;
    int k;
    log_row r = {.w = axis_at(&g->y, fine_y, &j, &k)};
    r.fj = im->f + (size_t)j * g->stride;
    r.fk = im->f + (size_t)k * g->stride;
    r.ej = im->e + (size_t)j * g->stride;
    r.ek = im->e + (size_t)k * g->stride;
    return r;
}

const double *image_row_view(const image *im, const image_grid *g, int fine_y, int x0, int x1,
                             double *scratch) {
    if (g->x.kind == AXIS_NONE) {
        return im->pixels + (size_t)fine_y * (size_t)g->x.n + x0;
    }
    combine(im, g, fine_y, x0, x1, scratch);
    if (g->log) {
        undo_log(scratch, x1 - x0, g->pedestal);
    }
    return scratch;
}

void image_row(const image *im, const image_grid *g, int fine_y, int x0, int x1, double *out) {
    const double *row = image_row_view(im, g, fine_y, x0, x1, out);
    if (row != out) {
        memcpy(out, row, (size_t)(x1 - x0) * sizeof *out);
    }
}

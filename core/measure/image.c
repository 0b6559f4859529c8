/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/image.h"

#include "fft/fft.h"

#include <math.h>
#include <string.h>

/* What zeros=floor puts for a zero, in units of the image's brightest pixel: relative, so that the
 * result scales with the flux. */
static const double floor_of_peak = 1e-12;

static int axis_kind_of(int interpolation)
{
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

bool image_grid_init(image_grid *g, int nx, int ny, int interpolation, int s, int zeros, double pedestal)
{
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

void image_grid_deinit(image_grid *g)
{
    axis_deinit(&g->x);
    axis_deinit(&g->y);
}

bool image_init(image *im, const image_grid *g)
{
    *im = (image){0};
    if (g->x.kind == AXIS_NONE) {
        return true;
    }
    const size_t numbers = (size_t)g->y.n * g->stride;
    im->f = fft_alloc(numbers * sizeof *im->f);
    im->e = fft_alloc(numbers * sizeof *im->e);
    im->line = fft_alloc(2 * (size_t)g->x.n * sizeof *im->line);
    return im->f != NULL && im->e != NULL && im->line != NULL;
}

void image_deinit(image *im)
{
    fft_free(im->f);
    fft_free(im->e);
    fft_free(im->line);
    *im = (image){0};
}

static void extremes(const double *pixels, size_t n, double *low, double *high)
{
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

/* ln of a row of pixels. Zeros become marks (ln 0) or, under zeros=floor, the logarithm of `tiny`. */
static void take_log(const double *pixels, int n, double pedestal, double tiny, double *out)
{
#pragma omp simd
    for (int i = 0; i < n; i++) {
        const double value = pixels[i] + pedestal;
        out[i] = log(value > tiny ? value : tiny);
    }
}

static void find_negative(const image_grid *g, const double *pixels, int *bad_x, int *bad_y)
{
    int i = 0;
    while (!(pixels[i] + g->pedestal < 0.0)) {
        i++;
    }
    *bad_x = i % g->x.n;
    *bad_y = i / g->x.n;
}

/* One row of pixels to a row that is fine along x. */
static void expand_row(image *im, const image_grid *g, const double *pixels, double tiny, double *out)
{
    double *values = im->line;
    double *slopes = im->line + g->x.n;
    if (g->log) {
        take_log(pixels, g->x.n, g->pedestal, tiny, values);
    } else {
        memcpy(values, pixels, (size_t)g->x.n * sizeof *values);
    }
    if (im->marked) {
        axis_slopes_marked(&g->x, values, slopes, 1);
    } else {
        axis_slopes(&g->x, values, slopes, 1, 1);
    }
    axis_expand(&g->x, values, slopes, im->marked, out);
}

bool image_load(image *im, const image_grid *g, const double *pixels, int *bad_x, int *bad_y)
{
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
        tiny = has_zeros && !im->marked ? floor_of_peak * (high + g->pedestal) : 0.0;
    }
    for (int j = 0; j < g->y.n; j++) {
        expand_row(im, g, pixels + (size_t)j * (size_t)g->x.n, tiny, im->f + (size_t)j * g->stride);
    }
    if (!im->marked) {
        axis_slopes(&g->y, im->f, im->e, g->stride, g->fine_nx);
    } else {
        for (int i = 0; i < g->fine_nx; i++) {
            axis_slopes_marked(&g->y, im->f + i, im->e + i, g->stride);
        }
    }
    return true;
}

static void combine(const image *im, const image_grid *g, int fine_y, int x0, int x1, double *out)
{
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
#pragma omp simd
        for (int i = 0; i < n; i++) {
            out[i] = w.a * fj[i] + w.b * fk[i];
        }
    } else {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            out[i] = w.a * fj[i] + w.b * fk[i] + w.c * ej[i] + w.d * ek[i];
        }
    }
}

void image_row(const image *im, const image_grid *g, int fine_y, int x0, int x1, double *out)
{
    if (g->x.kind == AXIS_NONE) {
        memcpy(out, im->pixels + (size_t)fine_y * (size_t)g->x.n + x0, (size_t)(x1 - x0) * sizeof *out);
        return;
    }
    combine(im, g, fine_y, x0, x1, out);
    if (g->log) {
        const double pedestal = g->pedestal;
#pragma omp simd
        for (int i = 0; i < x1 - x0; i++) {
            out[i] = exp(out[i]) - pedestal;
        }
    }
}

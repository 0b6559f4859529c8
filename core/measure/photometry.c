/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/photometry.h"

#include "base/simd.h"

#include <math.h>

/* Each image's sum and extremes, whether it is finite, and the noise's squares; both in one loop,
 * so that the pair is fetched once. */
SHEAR_SIMD photometry photometry_of(const double *galaxy, const double *noise, size_t pixels) {
    /* Squares are taken about one of the pixels: about zero, a bright sky would swallow its own
     * noise. */
    const double origin = noise[0];
    double g_sum = 0.0;
    double n_sum = 0.0;
    double n_sum1 = 0.0;
    double n_sum2 = 0.0;
    double g_low = INFINITY;
    double g_high = -INFINITY;
    double n_low = INFINITY;
    double n_high = -INFINITY;
    double g_odd = 0.0; /* becomes NaN with the first NaN or infinity */
    double n_odd = 0.0;
#pragma omp simd reduction(+ : g_sum, n_sum, n_sum1, n_sum2, g_odd, n_odd)                         \
    reduction(min : g_low, n_low) reduction(max : g_high, n_high)
    for (size_t i = 0; i < pixels; i++) {
        const double g = galaxy[i];
        const double n = noise[i];
        const double d = n - origin;
        g_sum += g;
        g_odd += g * 0.0;
        g_low = g < g_low ? g : g_low;
        g_high = g > g_high ? g : g_high;
        n_sum += n;
        n_odd += n * 0.0;
        n_low = n < n_low ? n : n_low;
        n_high = n > n_high ? n : n_high;
        n_sum1 += d;
        n_sum2 += d * d;
    }
    const double mean = n_sum1 / (double)pixels;
    return (photometry){
        .galaxy_sum = g_sum,
        .noise_sum = n_sum,
        .galaxy_finite = g_odd == 0.0,
        .noise_finite = n_odd == 0.0,
        .galaxy_flat = g_low == g_high,
        .noise_var = n_high > n_low ? fmax(0.0, n_sum2 / (double)pixels - mean * mean) : 0.0};
}

/* Sums of the border about `origin`: its pixels, and their squares. */
static void sum_border(const double *pixels, int nx, int ny, double origin, double *sum,
                       double *squares) {
    const double *last = pixels + (size_t)(ny - 1) * (size_t)nx;
    double s1 = 0.0;
    double s2 = 0.0;
#pragma omp simd reduction(+ : s1, s2)
    for (int x = 0; x < nx; x++) {
        const double bottom = pixels[x] - origin;
        const double top = last[x] - origin;
        s1 += bottom + top;
        s2 += bottom * bottom + top * top;
    }
    for (int y = 1; y < ny - 1; y++) {
        const double left = pixels[(size_t)y * (size_t)nx] - origin;
        const double right = pixels[(size_t)(y + 1) * (size_t)nx - 1] - origin;
        s1 += left + right;
        s2 += left * left + right * right;
    }
    *sum = s1;
    *squares = s2;
}

border border_of(const double *pixels, int nx, int ny) {
    const double n = 2.0 * (nx + ny) - 4.0;
    double sum;
    double squares;
    sum_border(pixels, nx, ny, pixels[0], &sum, &squares); /* about a pixel: see photometry_of */
    return (border){.mean = pixels[0] + sum / n,
                    .var = fmax(0.0, squares - sum * sum / n) / (n - 1)};
}

SHEAR_SIMD double photometry_removed(const double *filter, const double *galaxy,
                                     const double *noise, size_t pixels) {
    double removed = 0.0;
#pragma omp simd reduction(+ : removed)
    for (size_t i = 0; i < pixels; i++) {
        removed += (1.0 - filter[i]) * (galaxy[i] - noise[i]);
    }
    return removed;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/photometry.h"

#include "base/simd.h"
#include "shear/stamp.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void fill(double *lanes, double value) {
    for (size_t l = 0; l < FFT_LANES; l++)
        lanes[l] = value;
}

void photometry_begin(photometry_sums *s, const double *galaxy, const double *noise, int nx, int ny,
                      double *most) {
    *s = (photometry_sums){.galaxy = galaxy,
                           .noise = noise,
                           .nx = nx,
                           .ny = ny,
                           .galaxy_origin = galaxy[0],
                           .noise_origin = noise[0],
                           .most = most};
    fill(s->strip_most, -INFINITY);
    fill(s->galaxy_least, INFINITY);
    fill(s->noise_most, -INFINITY);
    fill(s->noise_least, INFINITY);
}

SHEAR_SIMD static void add_strip(photometry_sums *sums, const double *galaxy, const double *noise,
                                 size_t y0, size_t y1) {
    const size_t step = (size_t)sums->nx;
    photometry_sums s = *sums; /* a local copy stays in registers */
    for (size_t y = y0; y < y1; y++) {
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++)
            photometry_pixel(&s, l, galaxy[y * step + l], noise[y * step + l]);
    }
    *sums = s;
}

void photometry_add(photometry_sums *s, int x0, int skip, int y0, int y1) {
    const double *galaxy = s->galaxy + x0;
    const double *noise = s->noise + x0;
    if (skip == 0 && y0 < y1) {
        add_strip(s, galaxy, noise, (size_t)y0, (size_t)y1);
        return;
    }
    for (size_t y = (size_t)y0; y < (size_t)y1; y++) {
        for (size_t l = (size_t)skip; l < FFT_LANES; l++) {
            const size_t at = y * (size_t)s->nx + l;
            photometry_pixel(s, l, galaxy[at], noise[at]);
        }
    }
}

static bool all_finite(const double *pixels, size_t n) {
    size_t i = 0;
    while (i < n && isfinite(pixels[i]))
        i++;
    return i == n;
}

static double smallest(const double *lanes) {
    double least = lanes[0];
    for (size_t l = 1; l < FFT_LANES; l++)
        least = lanes[l] < least ? lanes[l] : least;
    return least;
}

void photometry_end_strip(photometry_sums *s) {
    s->most[s->strips++] = fft_largest(s->strip_most);
    fill(s->strip_most, -INFINITY);
}

photometry photometry_end(const photometry_sums *s) {
    const size_t pixels = (size_t)s->nx * (size_t)s->ny;
    const double noise_sum = fft_total(s->noise_sum);
    const double mean = noise_sum / (double)pixels;
    const double var = fmax(0.0, fft_total(s->noise_squares) / (double)pixels - mean * mean);
    photometry p = {.flux = fft_total(s->galaxy_sum) - noise_sum +
                            (double)pixels * (s->galaxy_origin - s->noise_origin),
                    .galaxy_finite = true,
                    .noise_finite = true,
                    .galaxy_most = -INFINITY,
                    .galaxy_least = smallest(s->galaxy_least),
                    .noise_most = fft_largest(s->noise_most),
                    .noise_least = smallest(s->noise_least),
                    .noise_mean = s->noise_origin + mean};
    for (int i = 0; i < s->strips; i++)
        p.galaxy_most = p.galaxy_most > s->most[i] ? p.galaxy_most : s->most[i];
    p.galaxy_flat = p.galaxy_most == p.galaxy_least;
    p.noise_var = p.noise_most > p.noise_least ? var : 0.0;
    /* A NaN or an infinity propagates into the sums; finite pixels of 1e308 may overflow them,
     * too. */
    if (!isfinite(p.flux) || !isfinite(mean)) {
        p.galaxy_finite = all_finite(s->galaxy, pixels);
        p.noise_finite = all_finite(s->noise, pixels);
    }
    return p;
}

photometry photometry_of(const double *galaxy, const double *noise, int nx, int ny, double *most) {
    photometry_sums sums;
    photometry_begin(&sums, galaxy, noise, nx, ny, most);
    for (int x = 0; x < nx; x += FFT_LANES) {
        const int x0 = x <= nx - FFT_LANES ? x : nx - FFT_LANES;
        photometry_add(&sums, x0, x - x0, 0, ny);
        photometry_end_strip(&sums);
    }
    return photometry_end(&sums);
}

bool photometry_holds(const double *pixels, size_t n, double value) {
    /* Files of floats hold the nearest float. */
    const double narrow = fabs(value) <= (double)FLT_MAX ? (double)(float)value : value;
    size_t i = 0;
    while (i < n && pixels[i] != value && pixels[i] != narrow)
        i++;
    return i < n;
}

/* Return the distance from a number of this size to the next one with so many binary digits. */
static double spacing(double size, int digits) {
    int exponent = 0;
    (void)frexp(size, &exponent);
    return ldexp(1.0, exponent - digits);
}

static bool all_floats(const double *pixels, size_t n) {
    size_t i = 0;
    while (i < n && pixels[i] == (double)(float)pixels[i])
        i++;
    return i == n;
}

bool photometry_is_rounding(const double *pixels, size_t n, double least, double most,
                            double peak) {
    static const double of_doubles = 64.0; /* spacings: more than transforms round */
    /* spacings, so four adjacent floats: noise with an rms of less than half a spacing */
    static const double of_floats = 3.0;
    const double range = most - least;
    const double size = fmax(fabs(least), fabs(most));
    if (range <= of_doubles * spacing(fmax(size, fabs(peak)), DBL_MANT_DIG))
        return true;
    return size <= (double)FLT_MAX && range <= of_floats * spacing(size, FLT_MANT_DIG) &&
           all_floats(pixels, n);
}

/* Add n rows of pixels minus `origin` to columns [nx] and lanes. */
static SHEAR_INLINE void add_rows(const double *rows, size_t nx, size_t n, double origin,
                                  const double *next, double *columns, double *lanes) {
    size_t x = 0;
    for (; x + FFT_LANES <= nx; x += FFT_LANES) {
        for (size_t y = 0; y < n; y++)
            __builtin_prefetch(next + y * nx + x);
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            double sum = 0.0;
            for (size_t y = 0; y < n; y++)
                sum += rows[y * nx + x + l] - origin;
            columns[x + l] += sum;
            lanes[l] += sum;
        }
    }
    for (; x < nx; x++) {
        for (size_t y = 0; y < n; y++) {
            columns[x] += rows[y * nx + x] - origin;
            lanes[x % FFT_LANES] += rows[y * nx + x] - origin;
        }
    }
}

/* Return the sum of some rows, and add them to the sums of their columns; lane by lane, the same on
 * every machine. */
SHEAR_SIMD static double sum_strip(const double *rows, size_t nx, size_t n, double origin,
                                   const double *next, double *columns) {
    enum { AT_ONCE = 4 };
    double lanes[FFT_LANES] = {0};
    size_t y = 0;
    for (; y + AT_ONCE <= n; y += AT_ONCE)
        add_rows(rows + y * nx, nx, AT_ONCE, origin, next + y * nx, columns, lanes);
    for (; y < n; y++)
        add_rows(rows + y * nx, nx, 1, origin, next + y * nx, columns, lanes);
    return fft_total(lanes);
}

static double sum_of(const double *values, int n) {
    double lanes[FFT_LANES] = {0};
    for (int i = 0; i < n; i++)
        lanes[i % FFT_LANES] += values[i];
    return fft_total(lanes);
}

/* A side of n pixels in strips: two quarters, the middle pixel of an odd side, and two quarters. */
enum { STRIPS = 5 };
typedef struct strips {
    int from[STRIPS + 1];
} strips;

static strips strips_of(int n) {
    const int quarter = n / 4;
    const int half = n / 2;
    return (strips){{0, quarter, half, n - half, n - quarter, n}};
}

/* Return the third difference of the strips' means, scaled so that for white noise its variance is
 * that of the mean of all pixels. */
static double third_difference(const double *sums, int n, int across) {
    const int quarter = n / 4;
    const int half = n / 2;
    const double n_outer = (double)across * quarter;
    const double n_inner = (double)across * (half - quarter);
    /* distance of the outer strips from the centre over that of the inner ones */
    const double farther = (double)(n - quarter) / (n - quarter - half);
    const double third = (sums[0] - sums[4]) / n_outer - farther * (sums[1] - sums[3]) / n_inner;
    const double variance = 2.0 / n_outer + farther * farther * 2.0 / n_inner;
    return third / sqrt(variance * across * n);
}

sky_level photometry_level(const double *pixels, int nx, int ny, const double *next) {
    const strips along_x = strips_of(nx);
    const strips along_y = strips_of(ny);
    double columns[SHEAR_MAX_SIDE];
    double x[STRIPS];
    double y[STRIPS];
    double all = 0.0;
    memset(columns, 0, (size_t)nx * sizeof *columns);
    for (int i = 0; i < STRIPS; i++) {
        const size_t at = (size_t)nx * (size_t)along_y.from[i];
        y[i] = sum_strip(pixels + at, (size_t)nx, (size_t)(along_y.from[i + 1] - along_y.from[i]),
                         pixels[0], next + at, columns);
        all += y[i];
    }
    for (int i = 0; i < STRIPS; i++)
        x[i] = sum_of(columns + along_x.from[i], along_x.from[i + 1] - along_x.from[i]);
    const double mean = pixels[0] + all / ((double)nx * ny);
    const double s_x = third_difference(x, nx, ny);
    const double s_y = third_difference(y, ny, nx);
    return (sky_level){.mean = mean, .own = mean + sqrt(s_x * s_x + s_y * s_y)};
}

/* Sums of the border about `origin`: of each side's pixels (corners belong to rows), and of the
 * squares of all. */
typedef struct border_sums {
    double bottom, top, left, right, squares;
} border_sums;

SHEAR_SIMD static void sum_border(const double *pixels, int nx, int ny, double origin,
                                  border_sums *out) {
    const double *last = pixels + (size_t)(ny - 1) * (size_t)nx;
    double s1 = 0.0;
    double s2 = 0.0;
    double s3 = 0.0;
    double s4 = 0.0;
    double squares = 0.0;
#pragma omp simd reduction(+ : s1, s2, squares)
    for (int x = 0; x < nx; x++) {
        const double bottom = pixels[x] - origin;
        const double top = last[x] - origin;
        s1 += bottom;
        s2 += top;
        squares += bottom * bottom + top * top;
    }
#pragma omp simd reduction(+ : s3, s4, squares)
    for (int y = 1; y < ny - 1; y++) {
        const double left = pixels[(size_t)y * (size_t)nx] - origin;
        const double right = pixels[(size_t)(y + 1) * (size_t)nx - 1] - origin;
        s3 += left;
        s4 += right;
        squares += left * left + right * right;
    }
    *out = (border_sums){.bottom = s1, .top = s2, .left = s3, .right = s4, .squares = squares};
}

border border_of(const double *pixels, int nx, int ny) {
    const double n = 2.0 * (nx + ny) - 4.0;
    border_sums s;
    sum_border(pixels, nx, ny, pixels[0], &s); /* about a pixel: see photometry_pixel */
    const double sum = s.bottom + s.top + s.left + s.right;
    return (border){.mean = pixels[0] + sum / n,
                    .var = fmax(0.0, s.squares - sum * sum / n) / (n - 1),
                    .step_x = (s.right - s.left) / (ny - 2),
                    .step_y = (s.top - s.bottom) / nx};
}

SHEAR_SIMD double photometry_removed(const double *filter, const double *galaxy,
                                     const double *noise, size_t pixels) {
    double removed = 0.0;
#pragma omp simd reduction(+ : removed)
    for (size_t i = 0; i < pixels; i++)
        removed += (1.0 - filter[i]) * (galaxy[i] - noise[i]);
    return removed;
}

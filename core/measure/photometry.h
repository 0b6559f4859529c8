/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/photometry.h: what is measured on the pixels of a stamp pair, before any transform.
 *
 * The pair is read strip by strip, so that each strip is still in the first-level cache when it is
 * packed. */
#pragma once

#include "base/simd.h"
#include "fft/fft.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct photometry {
    double flux; /* sum(galaxy) - sum(noise) */
    bool galaxy_finite, noise_finite;
    bool galaxy_flat;                 /* all pixels of the galaxy stamp are equal */
    double galaxy_most, galaxy_least; /* brightest and darkest pixel; NaN is ignored */
    double noise_most, noise_least;
    double noise_mean;
    double noise_var; /* about the mean; exactly 0 if all pixels are equal, in spite of rounding */
} photometry;

/* Running sums; lane l holds column l of a strip. */
typedef struct photometry_sums {
    const double *galaxy, *noise; /* [ny][nx] */
    int nx, ny;
    /* values that the sums are taken about; until the first pixel is added, the caller may set them
     * closer to the background */
    double galaxy_origin, noise_origin;
    double galaxy_sum[FFT_LANES], noise_sum[FFT_LANES], noise_squares[FFT_LANES];
    double strip_most[FFT_LANES]; /* of the galaxy's pixels since the last photometry_end_strip */
    double galaxy_least[FFT_LANES], noise_most[FFT_LANES], noise_least[FFT_LANES];
    double *most; /* brightest pixel of each finished strip of the galaxy stamp */
    int strips;
} photometry_sums;

/* Begin; the origins are the first pixels. `most` [(nx + FFT_LANES - 1) / FFT_LANES] is the
 * caller's memory for the strips' brightest pixels. Strip i begins at column i FFT_LANES, but the
 * last one ends at the last column. */
void photometry_begin(photometry_sums *s, const double *galaxy, const double *noise, int nx, int ny,
                      double *most);
/* Add rows [y0, y1) of columns [x0 + skip, x0 + FFT_LANES). Every pixel must be added once. */
void photometry_add(photometry_sums *s, int x0, int skip, int y0, int y1);
/* End a strip whose pixels have all been added. Strips come in order. */
void photometry_end_strip(photometry_sums *s);

/* Add one pixel of each stamp to lane l. Sums are taken about a value near the sky: about zero, a
 * bright sky would hide its own noise in the rounding. */
static SHEAR_INLINE void photometry_pixel(photometry_sums *s, size_t l, double galaxy,
                                          double noise) {
    const double d = noise - s->noise_origin;
    s->galaxy_sum[l] += galaxy - s->galaxy_origin;
    s->noise_sum[l] += d;
    s->noise_squares[l] += d * d;
    s->strip_most[l] = galaxy > s->strip_most[l] ? galaxy : s->strip_most[l];
    s->galaxy_least[l] = galaxy < s->galaxy_least[l] ? galaxy : s->galaxy_least[l];
    s->noise_most[l] = noise > s->noise_most[l] ? noise : s->noise_most[l];
    s->noise_least[l] = noise < s->noise_least[l] ? noise : s->noise_least[l];
}

photometry photometry_end(const photometry_sums *s);

/* Return the photometry of a whole pair. */
photometry photometry_of(const double *galaxy, const double *noise, int nx, int ny, double *most);

/* Return whether a pixel equals this value, as a double or rounded to a float. */
bool photometry_holds(const double *pixels, size_t n, double value);

/* Return whether pixels that range from `least` to `most` vary by no more than rounding: that of
 * doubles in a transform of pixels up to `peak` in size, or that of floats if all n pixels are
 * floats. */
bool photometry_is_rounding(const double *pixels, size_t n, double least, double most, double peak);

/* The background that a noise stamp shows, for itself and for its galaxy. `mean` is the mean of its
 * pixels. A galaxy stamp from which it is subtracted keeps its own noise and gains the mean's: the
 * power s^2 |F(k)|^2, where F is the filter's transform and s^2 the variance of a mean. The noise
 * stamp itself would lose as much. `own`, to be subtracted from the noise stamp, is therefore mean
 * + sqrt(s_x^2 + s_y^2), which is an rms of sqrt(2) s above the mean. s_x and s_y are the third
 * differences of the means of four strips along x and y, scaled to the variance s^2; neither a
 * gradient nor a curvature of the sky changes them. With this level both stamps have the same power
 * at every k, for white noise, and for correlated noise that is white on the scale of a quarter of
 * the stamp. */
typedef struct sky_level {
    double mean, own;
} sky_level;
/* Return the level of a noise stamp with sides of at least 8 px. Prefetch as many pixels of `next`,
 * which the caller reads by columns afterwards. */
sky_level photometry_level(const double *pixels, int nx, int ny, const double *next);

/* The one-pixel border of an image [ny][nx]: its mean and variance, and the steps: right minus left
 * side and top minus bottom side, as means per pixel. */
typedef struct border {
    double mean, var;
    double step_x, step_y;
} border;
border border_of(const double *pixels, int nx, int ny);

/* Return sum (1 - filter) (galaxy - noise). */
double photometry_removed(const double *filter, const double *galaxy, const double *noise,
                          size_t pixels);

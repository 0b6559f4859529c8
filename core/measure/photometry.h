/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/photometry.h: what the pixels of a stamp pair tell before anything is transformed. The
 * pair is read strip by strip, so that each strip is still in the first cache when it is packed. */
#ifndef SHEAR_MEASURE_PHOTOMETRY_H
#define SHEAR_MEASURE_PHOTOMETRY_H

#include "base/simd.h"
#include "fft/fft.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct photometry {
    double flux; /* galaxy - noise */
    bool galaxy_finite, noise_finite;
    bool galaxy_flat;                 /* all pixels of the galaxy stamp are equal */
    double galaxy_most, galaxy_least; /* brightest and darkest pixel; NaN does not count */
    double noise_most, noise_least;
    double noise_mean;
    double noise_var; /* about the mean; 0 where all pixels are equal, whatever rounding makes */
} photometry;

/* Sums so far, a column of a strip a lane. */
typedef struct photometry_sums {
    const double *galaxy, *noise; /* [ny][nx] */
    int nx, ny;
    double galaxy_origin, noise_origin; /* sums are about these; until the first pixel is added,
                                           they may be set to what is nearer to the background */
    double galaxy_sum[FFT_LANES], noise_sum[FFT_LANES], noise_squares[FFT_LANES];
    double strip_most[FFT_LANES]; /* of the galaxy's pixels since the last photometry_end_strip */
    double galaxy_least[FFT_LANES], noise_most[FFT_LANES], noise_least[FFT_LANES];
    double *most; /* the brightest pixel of each strip of the galaxy stamp that has been ended */
    int strips;
} photometry_sums;

/* The origins are the first pixels. `most` [(nx + FFT_LANES - 1) / FFT_LANES]: the caller's; it
 * becomes what the strips' brightest pixels are. Strip i begins at column i FFT_LANES, the last
 * where it still fits. */
void photometry_begin(photometry_sums *s, const double *galaxy, const double *noise, int nx, int ny,
                      double *most);
/* Rows [y0, y1) of columns [x0 + skip, x0 + FFT_LANES). Every pixel must be added once. */
void photometry_add(photometry_sums *s, int x0, int skip, int y0, int y1);
/* A strip's pixels have all been added; the strips come in order. */
void photometry_end_strip(photometry_sums *s);

/* One pixel of each stamp, to lane l. Sums are taken about something like the sky: about zero, a
 * bright sky would swallow its own noise. */
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

/* All of a pair at once. */
photometry photometry_of(const double *galaxy, const double *noise, int nx, int ny, double *most);

/* Is one of the pixels this value, as a double or rounded to a float? */
bool photometry_holds(const double *pixels, size_t n, double value);

/* Is what the pixels from `least` to `most` vary by no more than their rounding: as doubles beside
 * a transform's pixels up to `peak` in size, or as floats, where all of the n pixels are some? */
bool photometry_is_rounding(const double *pixels, size_t n, double least, double most, double peak);

/* What a noise stamp tells of the background under it and its galaxy. `mean` is that of its pixels.
 * A galaxy stamp that loses it keeps its own noise and gets the mean's: power s^2 |F(k)|^2 more, F
 * the filter's transform, s^2 the variance of a mean. The noise stamp itself would have as much
 * less. `own`, for it, is the mean and 2^(1/2) s from it: s from the third differences of the means
 * of four strips along each axis, which neither a gradient nor a curvature of the sky changes. With
 * it the two stamps have the same power at every k, of white noise, and of correlated noise that is
 * white on the scale of a quarter of the stamp. */
typedef struct sky_level {
    double mean, own;
} sky_level;
/* Sides of 8 px and more. As many pixels of `next` are fetched meanwhile: whoever reads them by
 * columns afterwards does not wait. */
sky_level photometry_level(const double *pixels, int nx, int ny, const double *next);

/* The one-pixel border of an image [ny][nx]: its mean and variance, and the means of its right and
 * top side over those of the sides opposite. */
typedef struct border {
    double mean, var;
    double step_x, step_y;
} border;
border border_of(const double *pixels, int nx, int ny);

/* sum (1 - filter) (galaxy - noise) */
double photometry_removed(const double *filter, const double *galaxy, const double *noise,
                          size_t pixels);

#endif

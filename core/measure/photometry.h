/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/photometry.h: what the pixels of a stamp pair tell before anything is transformed. The
 * pair is read strip by strip, so that each strip is still in the first cache when it is packed. */
#ifndef SHEAR_PHOTOMETRY_H
#define SHEAR_PHOTOMETRY_H

#include "base/simd.h"
#include "fft/fft.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct photometry {
    double flux; /* galaxy - noise */
    bool galaxy_finite, noise_finite;
    bool galaxy_flat; /* all pixels of the galaxy stamp are equal */
    double noise_mean;
    double noise_var; /* about the mean; 0 where all pixels are equal, whatever rounding makes */
} photometry;

/* Sums so far, a column of a strip a lane. */
typedef struct photometry_sums {
    const double *galaxy, *noise; /* [ny][nx] */
    int nx, ny;
    double galaxy_first, noise_first; /* the first pixels */
    double flux[FFT_LANES];
    double first[FFT_LANES], second[FFT_LANES]; /* noise and its squares, about its first pixel */
    double galaxy_others[FFT_LANES], noise_others[FFT_LANES]; /* unlike the first pixel */
} photometry_sums;

void photometry_begin(photometry_sums *s, const double *galaxy, const double *noise, int nx,
                      int ny);
/* Rows [y0, y1) of columns [x0 + skip, x0 + FFT_LANES). Every pixel must be added once. */
void photometry_add(photometry_sums *s, int x0, int skip, int y0, int y1);

/* One pixel of each stamp, to lane l. Squares are taken about one of the pixels: about zero, a
 * bright sky would swallow its own noise. */
static SHEAR_INLINE void photometry_pixel(photometry_sums *s, size_t l, double galaxy,
                                          double noise) {
    const double d = noise - s->noise_first;
    s->flux[l] += galaxy - noise;
    s->first[l] += d;
    s->second[l] += d * d;
    s->galaxy_others[l] += galaxy != s->galaxy_first ? 1.0 : 0.0;
    s->noise_others[l] += noise != s->noise_first ? 1.0 : 0.0;
}

photometry photometry_end(const photometry_sums *s);

/* All of a pair at once. */
photometry photometry_of(const double *galaxy, const double *noise, int nx, int ny);

/* The mean of an image's pixels: what there is of a background in a noise stamp. */
double photometry_level(const double *pixels, size_t n);

/* Mean and variance of the one-pixel border of an image [ny][nx]. */
typedef struct border {
    double mean, var;
} border;
border border_of(const double *pixels, int nx, int ny);

/* sum (1 - filter) (galaxy - noise) */
double photometry_removed(const double *filter, const double *galaxy, const double *noise,
                          size_t pixels);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/photometry.h: what one pass over the pixels of a stamp pair tells, before anything is
 * transformed. */
#ifndef SHEAR_PHOTOMETRY_H
#define SHEAR_PHOTOMETRY_H

#include <stdbool.h>
#include <stddef.h>

typedef struct photometry {
    double galaxy_sum, noise_sum;
    bool galaxy_finite, noise_finite;
    bool galaxy_flat; /* all pixels of the galaxy stamp are equal */
    double noise_var; /* about the mean; 0 where all pixels are equal, whatever rounding makes */
} photometry;

photometry photometry_of(const double *galaxy, const double *noise, size_t pixels);

/* Mean and variance of the one-pixel border of an image [ny][nx]. */
typedef struct border {
    double mean, var;
} border;
border border_of(const double *pixels, int nx, int ny);

/* sum (1 - filter) (galaxy - noise) */
double photometry_removed(const double *filter, const double *galaxy, const double *noise,
                          size_t pixels);

#endif

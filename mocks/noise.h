/* SPDX-License-Identifier: GPL-3.0-or-later */
/* noise.h: the three noises. Each takes its own random sequence, so that one does not move another.
 */
#ifndef MOCKS_NOISE_H
#define MOCKS_NOISE_H

#include "painter.h"
#include "random.h"

/* How a noise lies on its stamp: rotated by 90 degrees from x towards y, or as it is drawn. */
typedef struct noise_place {
    int nx, ny;
    bool rotated; /* square stamps only */
} noise_place;

/* Paint astronomical noise: Poisson-distributed points, `density` per px^2, each of `amplitude`,
 * convolved with the painter's PSF. They also lie around the image, as far as the PSF reaches: the
 * statistics are the same at its border. */
void noise_sources(painter *p, random_sequence *r, double density, double amplitude, bool rotated);

/* Replace each pixel f by a Poisson number of mean f + background, minus `subtract`. Item i of the
 * sequence is the pixel's own: its number depends on no other pixel's mean. */
void noise_photons(random_sequence *r, double background, double subtract, const noise_place *place,
                   double *image);

/* Add a Gaussian number of standard deviation sigma to each pixel. */
void noise_white(random_sequence *r, double sigma, const noise_place *place, double *image);

#endif

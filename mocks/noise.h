/* SPDX-License-Identifier: GPL-3.0-or-later */
/* noise.h: the three noises. Each takes its own random sequence, so that one does not move another.
 */
#ifndef MOCKS_NOISE_H
#define MOCKS_NOISE_H

#include "painter.h"
#include "random.h"

/* Paint astronomical noise: Poisson-distributed points, `density` per px^2, each of `amplitude`,
 * convolved with the painter's PSF. They also lie around the image, as far as the PSF reaches: the
 * statistics are the same at its border. */
void noise_sources(struct painter *p, struct random *r, double density, double amplitude);

/* Replace each pixel f by a Poisson number of mean f + background, minus `subtract`. Pixel i takes
 * item i of the sequence: its number depends on no other pixel's mean. */
void noise_photons(struct random *r, double background, double subtract, int n, double *image);

/* Add a Gaussian number of standard deviation sigma to each pixel. */
void noise_white(struct random *r, double sigma, int n, double *image);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* noise.h: the three kinds of noise. Each has its own random sequence, so that they do not depend
 * on each other. */
#pragma once

#include "painter.h"
#include "random.h"

/* The orientation of the noise on its stamp. */
typedef struct noise_place {
    int nx, ny;
    bool rotated; /* by 90 degrees from x towards y; square stamps only */
} noise_place;

/* Paint astronomical noise: a Poisson process of points, `density` per px^2, each of `amplitude`,
 * convolved with the painter's PSF. The points extend beyond the image as far as the PSF reaches,
 * so that the statistics do not change at the border. */
void noise_sources(painter *p, random_sequence *r, double density, double amplitude, bool rotated);

/* Replace each pixel f by a Poisson number of mean f + background, minus `subtract`. Each pixel has
 * its own item of the sequence, so that its number does not depend on the mean of other pixels. */
void noise_photons(random_sequence *r, double background, double subtract, const noise_place *place,
                   double *image);

/* Add a Gaussian random number of standard deviation sigma to each pixel. */
void noise_white(random_sequence *r, double sigma, const noise_place *place, double *image);

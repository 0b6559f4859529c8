/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/radial.h: what a filter does to the shear of a round galaxy, in one dimension.
 *
 * A profile is the galaxy's image, PSF included, at the radii (i + 1/2) RADIAL_STEP. For this
 * purpose the PSF is a Gaussian of its scale radius. */
#ifndef SHEAR_MEASURE_RADIAL_H
#define SHEAR_MEASURE_RADIAL_H

#include <stdbool.h>
#include <stddef.h>

#define RADIAL_STEP 0.5 /* px */

typedef struct radial {
    int n_r, n_k;
    double *r, *k;        /* [n_r] px, [n_k] radians/px */
    double *j0, *j1, *j2; /* [n_k][n_r] Bessel functions of k r */
    double *target;       /* [n_k] k^3 |W_beta|^2 / |W|^2 */
    double r_psf, beta;
    double *profile, *lensed;   /* [n_r] the galaxy, and what a shear adds: times cos(2 phi) */
    double *filtered, *changed; /* [n_r] scratch */
    double unfiltered;          /* the response without a filter */
} radial;

/* Up to r_max; beta > 0, r_psf > 0. False when memory is out. */
bool radial_init(radial *q, double r_max, double r_psf, double beta);
void radial_deinit(radial *q);

/* Take the profile in q->profile. */
void radial_load(radial *q);

/* The shear that is measured through the filter (measure/filter.h), over that without one. NaN
 * where the profile has none. */
double radial_response(radial *q, double core_px, double width_px);

#endif

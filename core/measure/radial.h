/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/radial.h: the effect of a filter on the shear of a round galaxy, in one dimension.
 *
 * A profile is the galaxy's image, PSF included, at the radii (i + 1/2) RADIAL_STEP. The PSF is
 * approximated by a Gaussian of its scale radius. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define RADIAL_STEP 0.5 /* px */

typedef struct radial {
    int n_r, n_k;
    void *memory;         /* of all arrays */
    double *r, *k;        /* [n_r] px, [n_k] radians/px */
    double *j0, *j1, *j2; /* [n_k][n_r] Bessel functions of k r */
    double *target;       /* [n_k] k^3 |W_beta|^2 / |W|^2 */
    double r_psf, beta;
    /* [n_r] the galaxy, and what a shear adds: the factor of cos(2 phi) */
    double *profile, *lensed;
    double *filtered, *changed; /* [n_r] scratch */
    double unfiltered;          /* the response without a filter */
} radial;

/* Make the tables up to radius r_max, pixels; beta > 0, r_psf > 0. Return false if out of
 * memory. */
bool radial_init(radial *q, double r_max, double r_psf, double beta);
void radial_deinit(radial *q);

/* Use the profile in q->profile from now on. */
void radial_load(radial *q);

/* Return the shear that is measured through the filter (measure/filter.h), over that without a
 * filter; NaN if the profile has none. */
double radial_response(radial *q, double core_px, double width_px);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/sharpness.h: how far a PSF lets a pixel stand out above its neighbours.
 *
 * The sky is a sum of PSFs with positive fluxes, at any places between the pixels. If each of them
 * obeys p <= ratio * min(mean of left and right, mean of below and above) + leak * flux, so does
 * their sum: no galaxy, star or blend of any shape can violate it. */
#pragma once

#include "measure/psf.h"

typedef struct sharpness {
    double ratio; /* the largest, over all places between the pixels, where the PSF has more than 2
                     % of its peak; INFINITY: there is no bound (the PSF lies within one pixel) */
    double leak;  /* the excess of the PSF's fainter parts over that bound, in units of its flux */
} sharpness;

/* Return the sharpness of a PSF image [ny][nx] with q samples per pixel, which need not pass
 * psf_check. Allocates nothing. Slow unless q is a whole number. */
sharpness sharpness_of(const double *psf, int nx, int ny, double q);

/* The same, of pixels that lie in any way on the samples: one pixel along x is x[2] samples, one
 * along y is y[2]. Slow. */
sharpness sharpness_on_pixels(const psf_view *image, const double *x, const double *y);

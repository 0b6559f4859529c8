/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/sharpness.h: how far a PSF lets a pixel stand out above its neighbours.
 *
 * Whatever is in the sky is a sum of PSFs at places between the pixels, with positive fluxes. Where
 * each of them obeys p <= ratio * min(mean of left and right, mean of below and above) + leak *
 * flux, so does their sum: no galaxy, star or blend of them, of whatever shape, can break it.
 */
#ifndef SHEAR_MEASURE_SHARPNESS_H
#define SHEAR_MEASURE_SHARPNESS_H

typedef struct sharpness {
    double ratio; /* over all places between the pixels where the PSF has more than 2 % of its
                     peak; INFINITY: there is no bound (a PSF that one pixel holds) */
    double leak;  /* what its fainter parts exceed that by, in units of its flux */
} sharpness;

/* Of a PSF image [ny][nx] with q samples per pixel. It need not be good (psf_check). Allocates
 * nothing. */
sharpness sharpness_of(const double *psf, int nx, int ny, int q);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_direct.h: |W(k)|^2 of a PSF image with any number of samples per pixel. */
#pragma once

#include "measure/psf_basis.h"
#include "shear/error.h"

/* Scratch for one image at a time. */
typedef struct psf_direct {
    psf_basis basis; /* the image as a model of one term */
    double *rows;    /* [2 FFT_LANES psf_nx] */
} psf_direct;
void psf_direct_place(psf_direct *d, const mode_plane *p, const psf_waves *w, arena *a);

/* Compute |W|^2 of an image into power[2 max_jx + 1][stride], where |k| < k_limit; W(0) = 1.
 * SHEAR_E_PSF. */
int psf_direct_power(psf_direct *d, const mode_plane *p, const psf_waves *w, const target_aim *aim,
                     const double *psf, double *power, shear_error *err);

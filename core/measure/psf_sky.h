/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_sky.h: |W|^2 of a PSF model whose samples lie along the axes of the sky, on the modes
 * of a galaxy's stamp: W(k) = W_uv(q), q = J^-T k (docs/method.md, section 3.3). */
#pragma once

#include "measure/target.h"
#include "shear/psf.h"

/* A model; immutable once filled. */
typedef struct psf_sky {
    const shear_psf_model *model; /* borrowed */
    double *flux;                 /* [terms] the sum of each plane */
    int n_kernel;                 /* Chebyshev coefficients of the Lanczos kernel's transform; 0: no
                                     kernel */
    double *kernel;               /* [n_kernel] */
} psf_sky;
void psf_sky_place(psf_sky *s, const shear_psf_model *m, arena *a);
void psf_sky_fill(psf_sky *s, const shear_psf_model *m);

/* Scratch for models of at most this size. */
typedef struct psf_sky_scratch {
    double *image;     /* [ny][nx] the galaxy's samples */
    double *parity[4]; /* [ny/2][nx/2] their sums and differences over (+-x, +-y) */
    double *x, *y;     /* [nx/2][cos, sin][2 FFT_LANES] of two columns, the same of y */
} psf_sky_scratch;
void psf_sky_scratch_place(psf_sky_scratch *s, int nx, int ny, arena *a);

/* Compute |W|^2, W(0) = 1, of the galaxy with coefficients c[terms] into power[2 max_jx +
 * 1][stride], where |q| < aim->limit. Return false if they are not those of a PSF, or its Jacobian
 * is no map. */
bool psf_sky_power(const psf_sky *s, psf_sky_scratch *scratch, const mode_plane *p,
                   const target_aim *aim, const double *jacobian, const double *c, double *power);

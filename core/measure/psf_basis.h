/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_basis.h: a PSF model on the modes of a stamp (docs/method.md, section 3.2).
 *
 * W(k) = sum_t c_t B_t(k); the B_t are transformed once for all galaxies, from the raw samples at
 * their own step. With SHEAR_PSF_AXES_MODES it is |W|^2 that is such a sum. */
#pragma once

#include "base/arena.h"
#include "measure/target.h"
#include "shear/psf.h"

/* The tables of one model; immutable. Groups of rows have their columns -reach .. reach only. */
typedef struct psf_basis {
    int terms;
    int parts;      /* 2: real and imaginary parts of W; 1: |W|^2 */
    int groups;     /* of FFT_LANES rows */
    int *reach;     /* [groups] the last jx inside the plane's circle */
    double *flux;   /* [terms] B_t(0) */
    double *values; /* [group][column][terms][parts][FFT_LANES] */
} psf_basis;

/* Place the tables. */
void psf_basis_place(psf_basis *b, const mode_plane *p, const shear_psf_model *m, arena *a);
/* Fill them. Return false if out of memory. */
bool psf_basis_fill(psf_basis *b, const mode_plane *p, const shear_psf_model *m);

/* Compute |W|^2, W(0) = 1, of the galaxy with coefficients c[terms] into power[2 max_jx +
 * 1][stride], where |q| < aim->limit. Return false if they are not those of a PSF: not finite,
 * or without positive flux. */
bool psf_basis_power(const psf_basis *b, const mode_plane *p, const target *aim, const double *c,
                     double *power);

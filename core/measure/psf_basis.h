/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_basis.h: a PSF model on the modes of a stamp (docs/method.md, section 3.3).
 *
 * W(k) = sum_t c_t B_t(k); the B_t are transformed once for all galaxies, from the raw samples at
 * their own step. With SHEAR_PSF_AXES_MODES it is |W|^2 that is such a sum. */
#pragma once

#include "measure/psf_waves.h"
#include "measure/target.h"

/* The tables of one model; immutable once filled. Groups of rows have columns -reach .. reach. */
typedef struct psf_basis {
    int terms;
    int parts;      /* 2: real and imaginary parts of W; 1: |W|^2 */
    int groups;     /* of FFT_LANES rows */
    int *reach;     /* [groups] the last jx inside the plane's circle */
    size_t *middle; /* [groups] where in `values` their column 0 begins */
    double *flux;   /* [terms] B_t(0) */
    double *values; /* [group][column][terms][parts][FFT_LANES] */
} psf_basis;

/* Place the tables. */
void psf_basis_place(psf_basis *b, const mode_plane *p, int terms, int parts, arena *a);
/* Fill them from samples[terms][ny][nx]. rows: scratch, [2 FFT_LANES nx]. */
void psf_basis_fill(psf_basis *b, const mode_plane *p, const psf_waves *w, const double *samples,
                    double *rows);
/* Fill them from |W|^2 on the modes of an nx x ny stamp: power[terms][ny][nx], mode 0 in the
 * middle. */
void psf_basis_fill_power(psf_basis *b, const mode_plane *p, const double *power);

/* Return the values of column 0 of a group, and the distance from column to column. */
const double *psf_basis_column(const psf_basis *b, int group);
size_t psf_basis_column_size(const psf_basis *b);

/* Scale coefficients [terms] so that W(0) = 1. Return false if they are not those of a PSF: not
 * finite, or without positive flux. */
bool psf_basis_scale(const psf_basis *b, const double *c, double *scaled);
/* Compute |W|^2, W(0) = 1, of the galaxy with coefficients c[terms] into power[2 max_jx +
 * 1][stride], where |q| < aim->limit. Return false as above. */
bool psf_basis_power(const psf_basis *b, const mode_plane *p, const target_aim *aim,
                     const double *c, double *power);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_transform.h: |W(k)|^2 of a PSF image with a whole number of samples per pixel, by
 * FFTs. */
#pragma once

#include "measure/mode_plane.h"
#include "measure/surface.h"
#include "shear/error.h"

/* What the transforms of one plan have in common. Immutable. */
typedef struct psf_transform {
    mode_plane plane;
    int psf_nx, psf_ny;           /* PSF image, samples */
    int q;                        /* samples per pixel in the transform (after interpolation) */
    surface_grid grid;            /* the interpolation */
    int period_nx, period_ny;     /* the stamp's period in samples: nx q, ny q */
    int psf_fine_nx, psf_fine_ny; /* of the interpolated PSF, without its closing cells */
    int used_nx, used_ny;         /* the part of the period that the PSF covers */
    fft_plan *along_x, *along_y;  /* lengths period_nx and period_ny; the caller's */
} psf_transform;

/* Derive the sizes; plane, image, q and grid must have been set. */
void psf_transform_set_sizes(psf_transform *p);

typedef struct psf_scratch {
    surface image;
    double *strip;         /* [fine ny][FFT_LANES] fine columns of the PSF */
    double *aliased;       /* [ny q][aliased_stride] the PSF, aliased onto the stamp's period */
    size_t aliased_stride; /* columns: whole pairs of strips of FFT_LANES */
    fft_lanes lanes[2];    /* [longer period + 1][FFT_LANES] for transforms */
    double *modes;         /* [group][re, im][aliased_stride][FFT_LANES] transformed along y */
} psf_scratch;
void psf_scratch_place(psf_scratch *t, const psf_transform *p, arena *a);

/* Compute |W|^2 of an image [psf_ny][psf_nx] into power[2 max_jx + 1][stride]; W(0) = 1.
 * SHEAR_E_PSF, SHEAR_E_NEGATIVE. */
int psf_transform_power(const psf_transform *p, psf_scratch *scratch, const double *psf,
                        double *power, shear_error *err);

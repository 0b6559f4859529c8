/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/transfer.h: T(k) = |W_beta(k)|^2 / |W(k)|^2 on the modes of a stamp, with the isotropic
 * cut.
 *
 * Modes: k = (2 pi jx / nx, 2 pi jy / ny) radians per galaxy pixel, kept for |jx| <= max_jx and 0
 * <= jy <= max_jy. Half the plane is enough, since |F(k)|^2 of a real image is even. Tables are
 * [jx][jy], so that rows of modes are vector lanes. T includes the weight of both halves (2 for jy
 * > 0) and the factor 1/(nx ny s^4), which turns sums over modes into integrals over the plane
 * (Parseval). */
#pragma once

#include "fft/fft.h"
#include "measure/surface.h"
#include "shear/error.h"

#include <stdbool.h>

/* What the transfers of one plan have in common. Immutable. */
typedef struct transfer_plan {
    int nx, ny;         /* stamp, pixels */
    int s;              /* fine pixels per pixel of the stamps */
    int psf_nx, psf_ny; /* PSF image, samples */
    int q;              /* PSF samples per pixel in the transform (after interpolation) */
    int max_jx, max_jy; /* the largest |jx| and |jy| of modes with |k| < k_limit */
    size_t stride;      /* rows of a column of T, whole groups of FFT_LANES */
    size_t table_size;  /* [2 max_jx + 1][stride] */
    double k_limit;     /* pi min(s, q): the Nyquist circle */
    double beta_px, threshold, power_tolerance;
    surface_grid grid;            /* the PSF's own interpolation */
    int period_nx, period_ny;     /* the stamp's period in samples: nx q, ny q */
    int psf_fine_nx, psf_fine_ny; /* of the interpolated PSF, without its closing cells */
    int used_nx, used_ny;         /* the part of the period that the PSF covers */
    fft_plan *along_x, *along_y;  /* lengths period_nx and period_ny; the caller's */
    double *ky2;                  /* [stride] ky^2; INFINITY beyond max_jy */
    double *target;               /* [2 max_jx + 1][stride] |W_beta|^2 times the factors of T */
} transfer_plan;

/* Place the tables, and fill them unless the arena only counts; the grid and the sizes must have
 * been set. */
void transfer_plan_place(transfer_plan *p, arena *a);

typedef struct transfer_scratch {
    surface image;
    double *strip;         /* [fine ny][FFT_LANES] fine columns of the PSF */
    double *aliased;       /* [ny q][aliased_stride] the PSF, aliased onto the stamp's period */
    size_t aliased_stride; /* columns: whole pairs of strips of FFT_LANES */
    fft_lanes lanes[2];    /* [longer period + 1][FFT_LANES] for transforms */
    double *modes;         /* [group][re, im][aliased_stride][FFT_LANES] transformed along y */
    double *power;         /* [2 max_jx + 1][stride] |W|^2 */
} transfer_scratch;
void transfer_scratch_place(transfer_scratch *t, const transfer_plan *p, arena *a);

typedef struct transfer {
    double k_cut;   /* T = 0 at |k| >= k_cut */
    double k_reach; /* and beyond it, where k^4 T is below 1e-15 of its largest value */
    int jx, jy;     /* the last modes that count: <= max_jx, max_jy */
    int *reach; /* [jy / FFT_LANES] the last jx that counts in this group of rows or a later one */
    double *t;  /* [2 max_jx + 1][stride], column max_jx + jx; whole groups of rows are filled */
} transfer;
/* Place the table; until it is made, any mode may count. */
void transfer_place(transfer *t, const transfer_plan *p, arena *a);

/* Compute |W|^2 of the image that the scratch has loaded into t->power; W(0) = 1. */
void transfer_find_power(const transfer_plan *p, transfer_scratch *t);

/* Make T for one PSF image. SHEAR_E_PSF, SHEAR_E_NEGATIVE, SHEAR_E_BETA. */
int transfer_make(transfer *t, const transfer_plan *p, transfer_scratch *scratch, const double *psf,
                  shear_error *err);

/* Return the part of the target's power, weighted with k^4 as in M4, that lies beyond k_cut: (1 + x
 * + x^2/2) exp(-x) with x = (beta k_cut)^2. */
double transfer_power_beyond(double beta_px, double k_cut);
/* Return the smallest beta, in steps of 1e-4 px, for which that part is at most `tolerance`;
 * INFINITY if there is none. */
double transfer_smallest_beta(double k_cut, double tolerance);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/transfer.h: T(k) = |W_beta|^2 / |W|^2 on the modes of a stamp (mode_plane.h), with the
 * isotropic cut. T includes the factors of the target (target.h). */
#pragma once

#include "measure/target.h"
#include "shear/error.h"

#include <stdbool.h>

/* What the transfers of one plan have in common. Immutable. */
typedef struct transfer_plan {
    mode_plane plane;
    int s; /* fine pixels per pixel of the stamps */
    double threshold, power_tolerance;
    double farthest; /* modes at |q| >= farthest do not count for galaxies that have a PSF model, or
                        a frame on the sky */
    target target;   /* of the pixel frame */
} transfer_plan;

typedef struct transfer {
    double k_cut;   /* T = 0 at |q| >= k_cut */
    double k_reach; /* and beyond it, where q^4 T is below 1e-15 of its largest value */
    int jx, jy;     /* the last modes that count: <= max_jx, max_jy */
    int *reach; /* [jy / FFT_LANES] the last jx that counts in this group of rows or a later one */
    double *t;  /* [2 max_jx + 1][stride], column max_jx + jx; whole groups of rows are filled */
} transfer;
/* Place the table; until it is made, any mode may count. */
void transfer_place(transfer *t, const mode_plane *p, arena *a);

/* Make T from |W|^2, W(0) = 1, on the modes where |q| < aim->limit; any others may hold any
 * number. SHEAR_E_BETA. */
int transfer_make(transfer *t, const transfer_plan *p, const double *power, shear_error *err);

/* Return the limit of |k|^2 inside a cut. */
double transfer_inside(double k_cut);
/* Return whether enough of the target's power lies inside a cut (power_tolerance). */
bool transfer_sees(const transfer_plan *p, double beta, double k_cut);
/* Return the part of the target's power, weighted with k^4 as in M4, that lies beyond k_cut: (1 + x
 * + x^2/2) exp(-x) with x = (beta k_cut)^2. */
double transfer_power_beyond(double beta_px, double k_cut);
/* Return the smallest beta, in steps of 1e-4 px, for which that part is at most `tolerance`;
 * INFINITY if there is none. */
double transfer_smallest_beta(double k_cut, double tolerance);

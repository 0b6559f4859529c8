/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/galaxy_transfer.h: T(k) of a galaxy whose PSF or frame is its own, made in one pass over
 * its modes.
 *
 * Along a row of modes the target is a Gaussian: it is multiplied from column to column. Nothing
 * but T itself is stored. */
#pragma once

#include "measure/psf_basis.h"
#include "measure/transfer.h"

/* Where |W|^2 comes from: a model's tables, with coefficients that make W(0) = 1, or a table. */
typedef struct galaxy_power {
    const psf_basis *basis; /* NULL: the table */
    const double *terms;    /* [basis->terms] */
    const double *table;    /* [2 max_jx + 1][stride] */
} galaxy_power;

/* Make T on the modes where |q| < aim->limit, which is also its reach. Return false if beta is too
 * small for the PSF. */
bool galaxy_transfer_make(transfer *t, const transfer_plan *p, const target_aim *aim,
                          const galaxy_power *power);

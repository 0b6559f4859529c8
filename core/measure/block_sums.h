/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/block_sums.h: the terms that a row adds to the sums of its block. */
#pragma once

#include "shear/sums.h"

/* Fill terms[SHEAR_N_TERMS] from an unflagged row; those of triples are 0. Return false if a term
 * is not finite, or so large (1e280) that sums of terms, or products of such sums, could overflow:
 * such a row cannot be used. */
bool block_terms(const shear_row *row, double *terms);

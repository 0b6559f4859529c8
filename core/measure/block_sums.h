/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/block_sums.h: what a row adds to the sums of its block. */
#ifndef SHEAR_MEASURE_BLOCK_SUMS_H
#define SHEAR_MEASURE_BLOCK_SUMS_H

#include "shear/sums.h"

/* The terms of an unflagged row, into terms[SHEAR_N_TERMS]. False where one is not finite, or so
 * large (1e280) that sums of them, or products of such sums, could leave the range of double: then
 * the row cannot be used. */
bool block_terms(const shear_row *row, double *terms);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/sign_histogram.h: how symmetric the values x - g b of many stamps are about 0, as a
 * function of g.
 *
 * The values are counted in bins of |value|, separately for the two signs: bin i keeps n_i - n_-i
 * and n_i + n_-i. All counts are integers, so that nothing depends on the order of stamps. */
#pragma once

#include "base/arena.h"

#include <stddef.h>
#include <stdint.h>

enum { SIGN_GROUPS = 8 }; /* groups of stamps */

typedef struct sign_histogram {
    size_t n;
    const double *x, *b;   /* [n] values, and their responses to g */
    const int32_t *weight; /* [n] integer weights, 0 .. SHEAR_SYMMETRY_WEIGHTS */
    const uint8_t *group;  /* [n] 0 .. SIGN_GROUPS-1; for sign_histogram_count only */
    int bins;
    const double *edge; /* [bins] lower edge of bin i of |value|; edge[0] = 0 */
} sign_histogram;

/* The counts of each group at one g, [SIGN_GROUPS][bins] each. A value of exactly 0 counts on
 * neither side. */
typedef struct sign_counts {
    int64_t *difference; /* sum of w on the positive side minus that on the negative side */
    int64_t *square;     /* sum of w^2 on both sides: the variance of the difference */
} sign_counts;

void sign_counts_place(sign_counts *counts, int bins, arena *a);

void sign_histogram_count(const sign_histogram *h, double g, sign_counts *counts);

/* Return a stamp's group: a hash of two of its terms, so that it does not depend on the stamp's
 * place. */
uint8_t sign_histogram_group(double first, double second);

/* Return the bin of |value|. */
int sign_histogram_bin(const sign_histogram *h, double size);

/* Return sum of w sign(x - g b), which falls through 0 at the weighted median of x/b. */
int64_t sign_histogram_balance(const sign_histogram *h, double g);

/* Fill edge[bins] with quantiles of |x - g b| over the stamps of non-zero weight; there must be at
 * least one. Bin i begins at the fraction 1 - (1 - i/bins)^2 of them: bins become finer towards the
 * tail, which holds the information on the shear of a Gaussian. scratch is [n]. */
void sign_histogram_quantiles(const sign_histogram *h, double g, double *scratch, double *edge);

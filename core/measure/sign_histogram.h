/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/sign_histogram.h: how symmetric the values x - g b of many stamps are about 0, as a
 * function of g.
 *
 * The values are counted in bins of |value|, the two sides of each apart: what is kept of bin i is
 * n_i - n_-i and n_i + n_-i. All counts are integers, so that nothing depends on the order of
 * stamps.
 */
#ifndef SHEAR_MEASURE_SIGN_HISTOGRAM_H
#define SHEAR_MEASURE_SIGN_HISTOGRAM_H

#include <stddef.h>
#include <stdint.h>

enum { SIGN_GROUPS = 8 }; /* of stamps */

typedef struct sign_histogram {
    size_t n;
    const double *x, *b;   /* [n] values, and their responses to g */
    const int32_t *weight; /* [n] whole weights, 0 .. SHEAR_SYMMETRY_WEIGHTS */
    const uint8_t *group;  /* [n] 0 .. SIGN_GROUPS-1; for sign_histogram_count_groups only */
    int bins;
    const double *edge; /* [bins] where bin i of |value| begins; edge[0] = 0 */
} sign_histogram;

/* The counts at one g: [bins] each. A value of exactly 0 is on neither side. */
typedef struct sign_counts {
    int64_t *difference; /* sum of w on the positive side minus that on the negative */
    int64_t *square;     /* sum of w^2 on both: the variance of the difference */
} sign_counts;

void sign_histogram_count(const sign_histogram *h, double g, sign_counts *counts);
/* The same of each group: [SIGN_GROUPS][bins]. */
void sign_histogram_count_groups(const sign_histogram *h, double g, sign_counts *counts);

/* A stamp's group: a hash of two of its terms, so that it is the same wherever the stamp stands. */
uint8_t sign_histogram_group(double first, double second);

/* The bin of |value|. */
int sign_histogram_bin(const sign_histogram *h, double size);

/* sum of w sign(x - g b): falls through 0 at the weighted median of x/b. */
int64_t sign_histogram_balance(const sign_histogram *h, double g);

/* Fill edge[bins] with quantiles of |x - g b| over the stamps of non-zero weight, of which there is
 * one at least. Bin i begins at the part 1 - (1 - i/bins)^2 of them: bins get finer towards the
 * tail, where a Gaussian's shear is. scratch [n]. */
void sign_histogram_quantiles(const sign_histogram *h, double g, double *scratch, double *edge);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/symmetry.h
 * Find the shear that makes a distribution symmetric (PDF symmetrization; Zhang, Zhang & Luo 2017).
 *
 * A shear g changes a stamp's terms by
 *
 *     N1 -> N1 + g1 (D + U') + g2 V'
 *     N2 -> N2 + g2 (D - U') + g1 V'
 *
 * with U' = -(beta^2/2) U and V' = -2 beta^2 V. Without shear the galaxies' random orientations
 * make the distributions of N1 and N2 symmetric about 0, so the estimate is the g for which those
 * of N1 - g1 (D + U') - g2 V' and N2 - g2 (D - U') - g1 V' are symmetric. Stamps are counted in
 * bins of |value| on both sides (quantiles, finer towards the tail), and
 *
 *     X(g) = 1/2 sum_i (n_i - n_-i)^2 / (n_i + n_-i)
 *
 * is minimized, one component after the other until both have converged. X is a step function. It
 * is approximated by a parabola: each bin's response to g is taken over a range as wide as the
 * galaxies' own scatter and, for few stamps, from a smooth curve through the bins, so that steps do
 * not move the minimum. The error comes from the parabola's curvature, found by cross-validation,
 * and the variance of the counts: it is right within 5 % for 200 stamps and more. A bright galaxy
 * counts no more than a faint one, whereas in the ratio of means bright galaxies cost precision.
 *
 * Weights: a stamp counts w times in its bin, and n_i + n_-i becomes the sum of w^2, the variance
 * of the difference. Weights are rounded to 1/SHEAR_SYMMETRY_WEIGHTS of the largest.
 *
 * Counts are integers and bins come from sorted values: the result is the same to the last bit for
 * any order of stamps. Memory: 56 bytes per stamp, and 29 more while solving.
 *
 * The errors assume that stamps are independent of each other: like those of the delta method they
 * are too large for rotated copies of the same galaxies.
 */
#ifndef SHEAR_SYMMETRY_H
#define SHEAR_SYMMETRY_H

#include "shear/error.h"
#include "shear/linkage.h"
#include "shear/settings.h"
#include "shear/sums.h"

#include <stddef.h>

SHEAR_BEGIN_C

/** Numbers of the symmetry. */
enum {
    SHEAR_SYMMETRY_BINS = 10,       /**< default number of bins on each side */
    SHEAR_SYMMETRY_MAX_BINS = 1000, /**< largest number of bins on each side */
    SHEAR_SYMMETRY_FEWEST = 16, /**< smallest number of stamps, in all and per bin (both sides) */
    SHEAR_SYMMETRY_WEIGHTS = 1 << 15, /**< steps of a weight */
    SHEAR_SYMMETRY_BYTES = 56         /**< bytes per stamp in shear_symmetry_bytes() */
};

/** The terms of a field's unflagged stamps. Not thread-safe: one owner at a time. */
typedef struct shear_symmetry shear_symmetry;
/** Allocate terms without stamps; *s is NULL on error. */
int shear_symmetry_new(shear_symmetry **s, shear_error *err);
/** Free the terms. NULL is accepted. */
void shear_symmetry_free(shear_symmetry *s);

/** Add a row with its cross terms, in any order. Flagged rows, and rows that no sum could hold, are
 * skipped. beta_px is that of the plan which measured it. */
int shear_symmetry_add(shear_symmetry *s, const shear_row *row, double beta_px, shear_error *err);
/** Add the stamps [from, count) of `other`: all or none. */
int shear_symmetry_join(shear_symmetry *s, const shear_symmetry *other, size_t from,
                        shear_error *err);
/** Keep only the first n stamps; no memory is freed. */
void shear_symmetry_truncate(shear_symmetry *s, size_t n);
/** Return the number of stamps. */
size_t shear_symmetry_count(const shear_symmetry *s);
/** Copy weight and D (the power, about flux^2) of each stamp, in the order of adding: [count]
 * each. */
void shear_symmetry_powers(const shear_symmetry *s, double *weight, double *d);

/** Write the stamps [from, count) as SHEAR_SYMMETRY_BYTES bytes each, in the order of adding; the
 * bytes are the same on every machine. */
void shear_symmetry_bytes(const shear_symmetry *s, size_t from, unsigned char *out);
/** Add stamps from their bytes: all or none. SHEAR_E_FORMAT if the size is not a whole number of
 * stamps, or a term is not finite. */
int shear_symmetry_add_bytes(shear_symmetry *s, const unsigned char *bytes, size_t size,
                             shear_error *err);

/** Solve for the shear: overwrite shear, errors, covariance, valid, jackknife (0) and estimator
 * (pdf-sym) of *out, which shear_field_result() has filled in. `bins` on each side, 0 =
 * SHEAR_SYMMETRY_BINS; fewer are used if a bin would have less than 16 stamps. The covariance is
 * that of the two parabolas' slopes, summed over stamps. With fewer than SHEAR_SYMMETRY_FEWEST
 * stamps, or without a minimum, `valid` is false and the shear NaN. SHEAR_E_NOMEM; SHEAR_E_SETTING
 * for too many bins. */
int shear_symmetry_solve(const shear_symmetry *s, int bins, shear_result *out, shear_error *err);

/** Compute a field's result by any estimator: shear_field_result() and, from `terms` (NULL for the
 * mean), shear_symmetry_solve(). On error *out is the result of the sums. */
int shear_estimate(enum shear_estimator estimator, const shear_field_sums *sums,
                   const shear_symmetry *terms, shear_result *out, shear_error *err);

SHEAR_END_C

#endif

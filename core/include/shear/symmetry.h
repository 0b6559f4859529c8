/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/symmetry.h: the shear that makes a distribution symmetric (PDF symmetrization; Zhang, Zhang
 * & Luo 2017).
 *
 * A shear g changes a stamp's terms by N1 -> N1 + g1 (D + U') + g2 V' and N2 -> N2 + g2 (D - U') +
 * g1 V', with U' = -(beta^2/2) U and V' = -2 beta^2 V. Without shear the galaxies' random
 * orientations make the distributions of N1 and N2 symmetric about 0, so the estimate is the g for
 * which those of N1 - g1 (D + U') - g2 V' and N2 - g2 (D - U') - g1 V' are: stamps are counted in
 * bins of |value| on both sides (quantiles, finer towards the tail), and
 *
 *     X(g) = 1/2 sum_i (n_i - n_-i)^2 / (n_i + n_-i)
 *
 * is minimised, one component after the other until both stand still. X is a step function: it is
 * made a parabola by taking each bin's response to g over a range as wide as the galaxies' own
 * scatter, and where there are few stamps by a smooth curve through the bins; what varies from step
 * to step does not touch the minimum then, and the error comes from the parabola's curvature, found
 * by cross-validation, and the variance of the counts: it is right within 5 % for 200 stamps and
 * more. A bright galaxy counts no more than a faint one, which is where the ratio of means loses
 * its precision.
 *
 * Weights: a stamp counts w times in its bin, and n_i + n_-i becomes the sum of w^2, the variance
 * of the difference. Weights are rounded to 1/SHEAR_SYMMETRY_WEIGHTS of the largest.
 *
 * Counts are integers and bins come from sorted values: the answer is the same to the last bit for
 * any order of stamps. Memory: 56 bytes a stamp are kept; solving takes 29 more for its time.
 *
 * The errors suppose that stamps are independent of each other: like the delta method's they are
 * too large for rotated copies of the same galaxies.
 */
#ifndef SHEAR_SYMMETRY_H
#define SHEAR_SYMMETRY_H

#include "shear/error.h"
#include "shear/settings.h"
#include "shear/sums.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SHEAR_SYMMETRY_BINS = 10, /* on each side, where none are asked for */
    SHEAR_SYMMETRY_MAX_BINS = 1000,
    SHEAR_SYMMETRY_FEWEST = 16,       /* stamps; a bin of both sides has as many at least */
    SHEAR_SYMMETRY_WEIGHTS = 1 << 15, /* steps of a weight */
    SHEAR_SYMMETRY_BYTES = 56         /* a stamp, in shear_symmetry_bytes */
};

/* The terms of a field's unflagged stamps. Not thread-safe: one owner at a time. */
typedef struct shear_symmetry shear_symmetry;
int shear_symmetry_new(shear_symmetry **s, shear_error *err);
void shear_symmetry_free(shear_symmetry *s);

/* Take a row in with its cross terms, in any order; flagged rows, and rows that no sum could hold,
 * are passed over. beta_px is that of the plan which measured it. */
int shear_symmetry_add(shear_symmetry *s, const shear_row *row, double beta_px, shear_error *err);
/* Take the stamps [from, count) of `other` in. All or nothing, as below. */
int shear_symmetry_join(shear_symmetry *s, const shear_symmetry *other, size_t from,
                        shear_error *err);
/* Back to the first n stamps; the memory is kept. */
void shear_symmetry_truncate(shear_symmetry *s, size_t n);
size_t shear_symmetry_count(const shear_symmetry *s);
/* Weight and D (the power, about flux^2) of each stamp, in the order of adding: [count] each. */
void shear_symmetry_powers(const shear_symmetry *s, double *weight, double *d);

/* As bytes, SHEAR_SYMMETRY_BYTES a stamp in the order of adding, the same on every machine: those
 * of the stamps [from, count) into out. And back: SHEAR_E_FORMAT where the size is not a whole
 * number of stamps, or a term is not finite. */
void shear_symmetry_bytes(const shear_symmetry *s, size_t from, unsigned char *out);
int shear_symmetry_add_bytes(shear_symmetry *s, const unsigned char *bytes, size_t size,
                             shear_error *err);

/* Overwrite shear, errors, covariance, valid, jackknife (0) and estimator (pdf-sym) of *out,
 * which shear_field_result has filled in. `bins` on each side, 0 = SHEAR_SYMMETRY_BINS. The
 * covariance is that of the two parabolas' slopes, summed over stamps. There are fewer bins where a
 * bin would have less than 16 stamps. With fewer than SHEAR_SYMMETRY_FEWEST stamps, or without a
 * minimum, `valid` is false and the shear NaN. Errors: SHEAR_E_NOMEM; SHEAR_E_SETTING for too many
 * bins. */
int shear_symmetry_solve(const shear_symmetry *s, int bins, shear_result *out, shear_error *err);

/* A field's result by the estimator that is asked for (enum shear_estimator): shear_field_result
 * and, of `terms` (NULL for the mean), shear_symmetry_solve. On error *out is that of the sums. */
int shear_estimate(enum shear_estimator estimator, const shear_field_sums *sums,
                   const shear_symmetry *terms, shear_result *out, shear_error *err);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bias_fit.h: multiplicative and additive bias: measured = (1 + m) true + c.
 *
 * Zhang (2010), eq. (11): a straight line through the same galaxies at several shears. Errors are
 * the jackknife's over the groups of galaxies, so that what is common to all shears (shapes, noise)
 * does not count as error of m.
 */
#ifndef VALIDATION_BIAS_FIT_H
#define VALIDATION_BIAS_FIT_H

#include "engine/jackknife.h"

enum { BIAS_MAX_SHEARS = 16 };

/* Which series of a sample's sums show which true shear. */
typedef struct shear_set {
    int n;
    int series[BIAS_MAX_SHEARS];
    double g[BIAS_MAX_SHEARS][2];
} shear_set;

typedef struct bias_fit {
    double m[2], m_err[2], c[2], c_err[2]; /* of g1 and g2 */
} bias_fit;
bias_fit bias_fit_lines(const jackknife_sums *s, const shear_set *set);

/* m of one set minus m of another of the same galaxies, and its error, of both components. */
void bias_fit_compare(const jackknife_sums *s, const shear_set *a, const shear_set *b, double dm[2],
                      double dm_err[2]);

/* The lowest orders of measured - true in the true shear, for shears along one axis at a time:
 * measured_i - g_i = c_i + m_i g_i + a |g|^2 g_i. `cubic` and its error are a, from both components
 * together. */
typedef struct bias_cubic {
    double m, m_err, cubic, cubic_err;
} bias_cubic;
bias_cubic bias_fit_cubic(const jackknife_sums *s, const shear_set *set);

#endif

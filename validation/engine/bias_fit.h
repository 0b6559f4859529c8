/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bias_fit.h: multiplicative and additive bias, measured = (1 + m) true + c.
 *
 * A straight line is fitted to the same galaxies at several shears, as in eq. (11) of Zhang (2010).
 * Errors are from the jackknife over groups of galaxies, so that anything common to all shears
 * (shapes, noise) does not contribute to the error of m. */
#pragma once

#include "engine/jackknife.h"

enum { BIAS_MAX_SHEARS = 16 };

/* The series of a sample's sums, and their true shears. */
typedef struct shear_set {
    int n;
    int series[BIAS_MAX_SHEARS];
    double g[BIAS_MAX_SHEARS][2];
} shear_set;

typedef struct bias_fit {
    double m[2], m_err[2], c[2], c_err[2]; /* of g1 and g2 */
} bias_fit;
bias_fit bias_fit_lines(const jackknife_sums *s, const shear_set *set);

/* Compute m of one set minus m of another of the same galaxies, with its error, for both
 * components. */
void bias_fit_compare(const jackknife_sums *s, const shear_set *a, const shear_set *b, double dm[2],
                      double dm_err[2]);

/* The lowest orders of measured - true for shears along one axis at a time: measured_i - g_i = c_i
 * + m_i g_i + a |g|^2 g_i. `cubic` is a, from both components together. */
typedef struct bias_cubic {
    double m, m_err, cubic, cubic_err;
} bias_cubic;
bias_cubic bias_fit_cubic(const jackknife_sums *s, const shear_set *set);

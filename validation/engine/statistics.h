/* SPDX-License-Identifier: GPL-3.0-or-later */
/* statistics.h: is a set of numbers what it should be? */
#ifndef VALIDATION_STATISTICS_H
#define VALIDATION_STATISTICS_H

#include <stddef.h>

/* A chi-square, its degrees of freedom, and the probability of one at least as large. */
typedef struct chi_square {
    double chi2, p;
    int dof;
} chi_square;

/* Hotelling's test: d[n] against zero under cov[n][n], a jackknife's over `groups` groups. The
 * covariance is itself an estimate, so the probability is from F, not from chi-square; directions
 * in which the numbers hardly differ (eigenvalues of the correlation matrix below 1e-10) are left
 * out. p = NaN where groups are too few. */
chi_square chi_square_of_covariance(const double *d, const double *cov, int n, int groups);
/* As text, "chi2 = 12.3 for 14 (p = 0.58)". Returns buf. */
char *chi_square_text(const chi_square *test, char *buf, size_t size);

/* ---- distributions ---- */

typedef struct spread {
    int n;
    double mean, mean_err;
    double width, width_err; /* standard deviation; its error from the fourth moment */
} spread;
/* Values that are not finite are left out. */
spread spread_of(const double *v, size_t n);

/* Kolmogorov-Smirnov distance of v[n] from a unit Gaussian, or from Student's t with `nu` degrees
 * of freedom where nu > 0; *p: its asymptotic probability. Sorts v; non-finite values are left out.
 */
double ks_distance(double *v, size_t n, double nu, double *p);

/* Straight line through the points: y = a + b x. */
void line_fit(size_t n, const double *x, const double *y, double *a, double *b);

#endif

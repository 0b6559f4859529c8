/* SPDX-License-Identifier: GPL-3.0-or-later */
/* statistics.h: statistical tests of the results: chi-square, Kolmogorov-Smirnov, spread, a line
 * fit. */
#pragma once

#include <stddef.h>

/* A chi-square, its degrees of freedom, and the probability of a larger or equal one. */
typedef struct chi_square {
    double chi2, p;
    int dof;
} chi_square;

/* Hotelling's test of d[n] against zero under cov[n][n], the jackknife covariance from `groups`
 * groups. The covariance is itself an estimate, so the probability is from the F distribution.
 * Directions with almost no scatter (eigenvalues of the correlation matrix below 1e-10) are left
 * out. p is NaN if there are too few groups. */
chi_square chi_square_of_covariance(const double *d, const double *cov, int n, int groups);
/* Write "chi2 = 12.3 for 14 (p = 0.58)" into buf. Returns buf. */
char *chi_square_text(const chi_square *test, char *buf, size_t size);

/* ---- distributions ---- */

typedef struct spread {
    int n;
    double mean, mean_err;
    double width, width_err; /* standard deviation, and its error from the fourth moment */
} spread;
/* Return the spread of the finite values of v[n]. */
spread spread_of(const double *v, size_t n);

/* Return the Kolmogorov-Smirnov distance of v[n] from a unit Gaussian or, if nu > 0, from Student's
 * t with `nu` degrees of freedom; *p: its asymptotic probability. Sorts v; values that are not
 * finite are left out. */
double ks_distance(double *v, size_t n, double nu, double *p);

/* Fit a straight line to the points: y = a + b x. */
void line_fit(size_t n, const double *x, const double *y, double *a, double *b);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/polynomial.h: the terms of a polynomial in several variables.
 *
 * The variables are in groups, and the exponents of a group add up to its degree at most. The first
 * variable's exponent runs fastest: 1, x, x^2, y, x y, y^2 for x and y in one group of degree 2.
 * This is the order of PSFEx; that of Piff is the same with the variables reversed. */
#pragma once

enum { POLYNOMIAL_VARIABLES = 8, POLYNOMIAL_DEGREE = 12, POLYNOMIAL_TERMS = 512 };

typedef struct polynomial {
    int variables;                     /* 0: a constant, 1 term */
    int group[POLYNOMIAL_VARIABLES];   /* of each variable, from 0 */
    int highest[POLYNOMIAL_VARIABLES]; /* exponent of each variable */
    int degree[POLYNOMIAL_VARIABLES];  /* of each group */
} polynomial;

/* Return the polynomial in `variables` variables of one group. */
polynomial polynomial_of(int variables, int degree);

/* Return the number of terms; POLYNOMIAL_TERMS + 1 if there are more than POLYNOMIAL_TERMS. */
int polynomial_count(const polynomial *p);
/* Compute the terms at u[variables]: c[polynomial_count()]. */
void polynomial_terms(const polynomial *p, const double *u, double *c);

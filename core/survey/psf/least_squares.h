/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/least_squares.h: weighted linear least squares with few unknowns. */
#pragma once

#include <stdbool.h>

/* Compute the matrix m[terms][n] by which n values y are multiplied to give the coefficients c that
 * minimise sum_i weight[i] (y[i] - sum_t c[t] basis[i][t])^2. Return false if they are not
 * determined. terms <= 16. */
bool least_squares_matrix(const double *basis, const double *weight, int n, int terms, double *m);

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/least_squares.h"

#include <assert.h>
#include <math.h>

enum { MOST_TERMS = 16 };

/* A pivot is 0 if it is smaller than this part of its diagonal element. */
static const double singular = 1e-10;

/* Decompose a[terms][terms] into L L^T; L replaces its lower triangle. Return false if a is not
 * positive definite. */
static bool decompose(double (*a)[MOST_TERMS], int terms) {
    for (int i = 0; i < terms; i++) {
        for (int j = 0; j <= i; j++) {
            const double diagonal = a[i][i];
            double sum = a[i][j];
            for (int k = 0; k < j; k++)
                sum -= a[i][k] * a[j][k];
            if (i == j && !(sum > singular * diagonal))
                return false;
            a[i][j] = i == j ? sqrt(sum) : sum / a[j][j];
        }
    }
    return true;
}

/* Solve L L^T x = b in place. */
static void solve(double (*l)[MOST_TERMS], int terms, double *b) {
    for (int i = 0; i < terms; i++) {
        for (int k = 0; k < i; k++)
            b[i] -= l[i][k] * b[k];
        b[i] /= l[i][i];
    }
    for (int i = terms - 1; i >= 0; i--) {
        for (int k = i + 1; k < terms; k++)
            b[i] -= l[k][i] * b[k];
        b[i] /= l[i][i];
    }
}

bool least_squares_matrix(const double *basis, const double *weight, int n, int terms, double *m) {
    double a[MOST_TERMS][MOST_TERMS] = {{0}};
    double b[MOST_TERMS];
    assert(terms <= MOST_TERMS);
    for (int i = 0; i < n; i++) {
        for (int s = 0; s < terms; s++) {
            for (int t = 0; t < terms; t++)
                a[s][t] += weight[i] * basis[i * terms + s] * basis[i * terms + t];
        }
    }
    if (!decompose(a, terms))
        return false;
    for (int i = 0; i < n; i++) {
        for (int t = 0; t < terms; t++)
            b[t] = weight[i] * basis[i * terms + t];
        solve(a, terms, b);
        for (int t = 0; t < terms; t++)
            m[t * n + i] = b[t];
    }
    return true;
}

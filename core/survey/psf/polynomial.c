/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/polynomial.h"

#include <stdbool.h>

polynomial polynomial_of(int variables, int degree) {
    polynomial p = {.variables = variables, .degree = {degree}};
    for (int i = 0; i < variables; i++)
        p.highest[i] = degree;
    return p;
}

/* Return whether exponents e[variables] are those of a term. */
static bool belongs(const polynomial *p, const int *e) {
    int sum[POLYNOMIAL_VARIABLES] = {0};
    for (int i = 0; i < p->variables; i++) {
        sum[p->group[i]] += e[i];
        if (e[i] > p->highest[i] || sum[p->group[i]] > p->degree[p->group[i]])
            return false;
    }
    return true;
}

/* Advance to the exponents of the next term. Return false after the last. */
static bool advance(const polynomial *p, int *e) {
    for (int i = 0; i < p->variables; i++) {
        e[i]++;
        if (belongs(p, e))
            return true;
        e[i] = 0;
    }
    return false;
}

int polynomial_count(const polynomial *p) {
    int e[POLYNOMIAL_VARIABLES] = {0};
    int n = 1;
    while (n <= POLYNOMIAL_TERMS && advance(p, e))
        n++;
    return n;
}

static double power(double u, int exponent) {
    double product = 1.0;
    for (int k = 0; k < exponent; k++)
        product *= u;
    return product;
}

void polynomial_terms(const polynomial *p, const double *u, double *c) {
    int e[POLYNOMIAL_VARIABLES] = {0};
    do {
        *c = 1.0;
        for (int i = 0; i < p->variables; i++)
            *c *= power(u[i], e[i]);
        c++;
    } while (advance(p, e));
}

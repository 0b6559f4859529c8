/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/bias_fit.h"

#include "engine/statistics.h"

#include <math.h>

/* Compute m1, c1, m2, c2. */
static void fit_lines(const jackknife_total *totals, const void *context, double *out) {
    const shear_set *set = context;
    for (int c = 0; c < 2; c++) {
        double x[BIAS_MAX_SHEARS];
        double y[BIAS_MAX_SHEARS];
        for (int i = 0; i < set->n; i++) {
            x[i] = set->g[i][c];
            y[i] = totals[set->series[i]].g[c] - x[i];
        }
        line_fit((size_t)set->n, x, y, &out[2 * c + 1], &out[2 * c]);
    }
}

bias_fit bias_fit_lines(const jackknife_sums *s, const shear_set *set) {
    enum { N = 4 };
    double v[N];
    double cov[N * N];
    bias_fit fit;
    jackknife_covariance(s, fit_lines, set, N, v, cov);
    for (int c = 0; c < 2; c++) {
        fit.m[c] = v[2 * c];
        fit.c[c] = v[2 * c + 1];
        fit.m_err[c] = sqrt(cov[2 * c * N + 2 * c]);
        fit.c_err[c] = sqrt(cov[(2 * c + 1) * N + 2 * c + 1]);
    }
    return fit;
}

static void fit_difference(const jackknife_total *totals, const void *context, double *out) {
    const shear_set *const *sets = context;
    double a[4];
    double b[4];
    fit_lines(totals, sets[0], a);
    fit_lines(totals, sets[1], b);
    out[0] = a[0] - b[0];
    out[1] = a[2] - b[2];
}

void bias_fit_compare(const jackknife_sums *s, const shear_set *a, const shear_set *b, double dm[2],
                      double dm_err[2]) {
    const shear_set *const sets[] = {a, b};
    double cov[4];
    jackknife_covariance(s, fit_difference, sets, 2, dm, cov);
    dm_err[0] = sqrt(cov[0]);
    dm_err[1] = sqrt(cov[3]);
}

/* Fit m and a in d_i = c_i + m g_i + a |g|^2 g_i by least squares. Shears come in pairs +g and -g,
 * so that the odd terms are independent of c, which is not fitted. */
static void fit_cubic(const jackknife_total *totals, const void *context, double *out) {
    const shear_set *set = context;
    double s11 = 0.0;
    double s12 = 0.0;
    double s22 = 0.0;
    double y1 = 0.0;
    double y2 = 0.0;
    for (int i = 0; i < set->n; i++) {
        const double *g = set->g[i];
        const double square = g[0] * g[0] + g[1] * g[1];
        for (int c = 0; c < 2; c++) {
            const double d = totals[set->series[i]].g[c] - g[c];
            const double x = square * g[c];
            s11 += g[c] * g[c];
            s12 += g[c] * x;
            s22 += x * x;
            y1 += d * g[c];
            y2 += d * x;
        }
    }
    const double det = s11 * s22 - s12 * s12;
    out[0] = (s22 * y1 - s12 * y2) / det;
    out[1] = (s11 * y2 - s12 * y1) / det;
}

bias_cubic bias_fit_cubic(const jackknife_sums *s, const shear_set *set) {
    double v[2];
    double cov[4];
    jackknife_covariance(s, fit_cubic, set, 2, v, cov);
    return (bias_cubic){v[0], sqrt(cov[0]), v[1], sqrt(cov[3])};
}

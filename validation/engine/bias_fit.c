/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/bias_fit.h"

#include "engine/statistics.h"

#include <math.h>

static double shear_of(const struct total *total, int c) {
    return (c != 0 ? total->n2 : total->n1) / total->d;
}

/* m1, c1, m2, c2 */
static void fit_lines(const struct total *totals, const void *context, double *out) {
    const shear_set *set = context;
    for (int c = 0; c < 2; c++) {
        double x[BIAS_MAX_SHEARS];
        double y[BIAS_MAX_SHEARS];
        for (int i = 0; i < set->n; i++) {
            x[i] = set->g[i][c];
            y[i] = shear_of(&totals[set->series[i]], c) - x[i];
        }
        line_fit((size_t)set->n, x, y, &out[2 * c + 1], &out[2 * c]);
    }
}

int bias_fit(const struct tally *t, const shear_set *set, struct bias *out, shear_error *err) {
    enum { N = 4 };
    double v[N];
    double cov[N * N];
    int code = tally_jackknife(t, fit_lines, set, N, v, cov, err);
    for (int c = 0; code == SHEAR_OK && c < 2; c++) {
        out->m[c] = v[2 * c];
        out->c[c] = v[2 * c + 1];
        out->m_err[c] = sqrt(cov[2 * c * N + 2 * c]);
        out->c_err[c] = sqrt(cov[(2 * c + 1) * N + 2 * c + 1]);
    }
    return code;
}

static void fit_difference(const struct total *totals, const void *context, double *out) {
    const shear_set *const *sets = context;
    double a[4];
    double b[4];
    fit_lines(totals, sets[0], a);
    fit_lines(totals, sets[1], b);
    out[0] = a[0] - b[0];
    out[1] = a[2] - b[2];
}

int bias_compare(const struct tally *t, const shear_set *a, const shear_set *b, double dm[2],
                 double dm_err[2], shear_error *err) {
    const shear_set *const sets[] = {a, b};
    double cov[4];
    int code = tally_jackknife(t, fit_difference, sets, 2, dm, cov, err);
    dm_err[0] = code != SHEAR_OK ? NAN : sqrt(cov[0]);
    dm_err[1] = code != SHEAR_OK ? NAN : sqrt(cov[3]);
    return code;
}

/* Least squares for m and a in d_i = c_i + m g_i + a |g|^2 g_i. The shears come in pairs +g and -g,
 * so that the odd terms do not mix with c, which is left out. */
static void fit_cubic(const struct total *totals, const void *context, double *out) {
    const shear_set *set = context;
    double s11 = 0.0;
    double s12 = 0.0;
    double s22 = 0.0;
    double y1 = 0.0;
    double y2 = 0.0;
    for (int i = 0; i < set->n; i++) {
        const double *g = set->g[i];
        double square = g[0] * g[0] + g[1] * g[1];
        for (int c = 0; c < 2; c++) {
            double d = shear_of(&totals[set->series[i]], c) - g[c];
            double x = square * g[c];
            s11 += g[c] * g[c];
            s12 += g[c] * x;
            s22 += x * x;
            y1 += d * g[c];
            y2 += d * x;
        }
    }
    double det = s11 * s22 - s12 * s12;
    out[0] = (s22 * y1 - s12 * y2) / det;
    out[1] = (s11 * y2 - s12 * y1) / det;
}

int bias_fit_cubic(const struct tally *t, const shear_set *set, nonlinear *out, shear_error *err) {
    double v[2];
    double cov[4];
    int code = tally_jackknife(t, fit_cubic, set, 2, v, cov, err);
    if (code == SHEAR_OK) {
        *out = (nonlinear){v[0], sqrt(cov[0]), v[1], sqrt(cov[3])};
    }
    return code;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statistics.h"

#include "base/sort.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_matrix.h>
#include <math.h>
#include <stdio.h>

/* Compute T^2 in the eigenvectors of the correlation matrix: the sum of the squared pulls along
 * them, divided by the eigenvalues. */
static chi_square hotelling(const gsl_matrix *vectors, const gsl_vector *values,
                            const gsl_vector *pull, int groups) {
    static const double floor_of_eigenvalues = 1e-10;
    chi_square test = {.p = NAN};
    for (size_t k = 0; k < values->size; k++) {
        const double value = gsl_vector_get(values, k);
        double dot = 0.0;
        for (size_t i = 0; i < pull->size; i++)
            dot += gsl_matrix_get(vectors, i, k) * gsl_vector_get(pull, i);
        if (value > floor_of_eigenvalues) {
            test.chi2 += dot * dot / value;
            test.dof++;
        }
    }
    const double n = groups - 1.0;
    const double p = test.dof;
    if (test.dof > 0 && n > p)
        test.p = gsl_cdf_fdist_Q(test.chi2 * (n - p + 1.0) / (n * p), p, n - p + 1.0);
    return test;
}

/* GSL itself ends the program if out of memory. */
chi_square chi_square_of_covariance(const double *d, const double *cov, int n, int groups) {
    const size_t size = (size_t)n;
    gsl_matrix *correlation = gsl_matrix_alloc(size, size);
    gsl_matrix *vectors = gsl_matrix_alloc(size, size);
    gsl_vector *values = gsl_vector_alloc(size);
    gsl_vector *pull = gsl_vector_alloc(size);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(size);
    for (int i = 0; i < n; i++) {
        gsl_vector_set(pull, (size_t)i, d[i] / sqrt(cov[i * n + i]));
        for (int j = 0; j < n; j++) {
            const double scale = sqrt(cov[i * n + i] * cov[j * n + j]);
            gsl_matrix_set(correlation, (size_t)i, (size_t)j, cov[i * n + j] / scale);
        }
    }
    gsl_eigen_symmv(correlation, values, vectors, w);
    const chi_square test = hotelling(vectors, values, pull, groups);
    gsl_matrix_free(correlation);
    gsl_matrix_free(vectors);
    gsl_vector_free(values);
    gsl_vector_free(pull);
    gsl_eigen_symmv_free(w);
    return test;
}

char *chi_square_text(const chi_square *test, char *buf, size_t size) {
    if (isnan(test->p)) {
        snprintf(buf, size, "chi2 = %.1f for %d (too few groups for a probability)", test->chi2,
                 test->dof);
    } else {
        snprintf(buf, size, "chi2 = %.1f for %d (p = %.2g)", test->chi2, test->dof, test->p);
    }
    return buf;
}

/* ---- distributions ---- */

spread spread_of(const double *v, size_t n) {
    spread m = {.mean = 0.0};
    double m2 = 0.0;
    double m4 = 0.0;
    for (size_t i = 0; i < n; i++) {
        m.n += isfinite(v[i]) ? 1 : 0;
        m.mean += isfinite(v[i]) ? v[i] : 0.0;
    }
    m.mean /= m.n;
    for (size_t i = 0; i < n; i++) {
        double d = isfinite(v[i]) ? v[i] - m.mean : 0.0;
        m2 += d * d / m.n;
        m4 += d * d * d * d / m.n;
    }
    m.width = sqrt(m2 * m.n / (m.n - 1.0));
    m.mean_err = m.width / sqrt(m.n);
    m.width_err = sqrt(fmax(m4 - m2 * m2, 0.0) / m.n) / (2.0 * m.width);
    return m;
}

/* Return Q_KS(lambda) by the alternating series if it converges fast, otherwise by its
 * theta-function transform. */
static double kolmogorov_q(double lambda) {
    double sum = 0.0;
    if (lambda < 1.18) {
        double x = exp(-M_PI * M_PI / (8.0 * lambda * lambda));
        for (int k = 1; k < 20; k += 2)
            sum += pow(x, k * k);
        return lambda > 0.0 ? 1.0 - sqrt(2.0 * M_PI) / lambda * sum : 1.0;
    }
    for (int k = 1; k < 20; k++)
        sum += (k % 2 != 0 ? 2.0 : -2.0) * exp(-2.0 * k * k * lambda * lambda);
    return sum;
}

double ks_distance(double *v, size_t n, double nu, double *p) {
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(v[i]))
            v[kept++] = v[i];
    }
    sort_doubles(v, kept);
    double d = 0.0;
    for (size_t i = 0; i < kept; i++) {
        double cdf = nu > 0.0 ? gsl_cdf_tdist_P(v[i], nu) : gsl_cdf_ugaussian_P(v[i]);
        d = fmax(d, fmax(cdf - (double)i / (double)kept, (double)(i + 1) / (double)kept - cdf));
    }
    double root = sqrt((double)kept);
    *p = kept > 0 ? kolmogorov_q((root + 0.12 + 0.11 / root) * d) : NAN;
    return d;
}

void line_fit(size_t n, const double *x, const double *y, double *a, double *b) {
    double mx = 0.0;
    double my = 0.0;
    double sxx = 0.0;
    double sxy = 0.0;
    for (size_t i = 0; i < n; i++) {
        mx += x[i] / (double)n;
        my += y[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        sxx += (x[i] - mx) * (x[i] - mx);
        sxy += (x[i] - mx) * (y[i] - my);
    }
    *b = sxy / sxx;
    *a = my - *b * mx;
}

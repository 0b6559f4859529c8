/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statistics.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_matrix.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

struct verdict verdict_of_pulls(const double *pulls, int n) {
    struct verdict v = {0};
    for (int i = 0; i < n; i++) {
        if (isfinite(pulls[i])) {
            v.chi2 += pulls[i] * pulls[i];
            v.dof++;
        }
    }
    v.p = v.dof > 0 ? gsl_cdf_chisq_Q(v.chi2, v.dof) : NAN;
    return v;
}

/* Hotelling's T^2 in the eigenvectors of the correlation matrix. */
static struct verdict hotelling(gsl_matrix *correlation, const gsl_vector *pull, gsl_vector *values,
                                gsl_matrix *vectors, gsl_eigen_symmv_workspace *w, int groups) {
    static const double floor_of_eigenvalues = 1e-10;
    struct verdict v = {.p = NAN};
    gsl_eigen_symmv(correlation, values, vectors, w);
    for (size_t k = 0; k < values->size; k++) {
        double value = gsl_vector_get(values, k);
        double dot = 0.0;
        for (size_t i = 0; i < pull->size; i++) {
            dot += gsl_matrix_get(vectors, i, k) * gsl_vector_get(pull, i);
        }
        if (value > floor_of_eigenvalues) {
            v.chi2 += dot * dot / value;
            v.dof++;
        }
    }
    double n = groups - 1.0;
    double p = v.dof;
    if (v.dof > 0 && n > p) {
        v.p = gsl_cdf_fdist_Q(v.chi2 * (n - p + 1.0) / (n * p), p, n - p + 1.0);
    }
    return v;
}

int verdict_of_covariance(const double *d, const double *cov, int n, int groups,
                          struct verdict *out, shear_error *err) {
    size_t size = (size_t)n;
    gsl_set_error_handler_off();
    gsl_matrix *correlation = gsl_matrix_alloc(size, size);
    gsl_matrix *vectors = gsl_matrix_alloc(size, size);
    gsl_vector *values = gsl_vector_alloc(size);
    gsl_vector *pull = gsl_vector_alloc(size);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(size);
    bool made =
        correlation != NULL && vectors != NULL && values != NULL && pull != NULL && w != NULL;
    for (int i = 0; made && i < n; i++) {
        gsl_vector_set(pull, (size_t)i, d[i] / sqrt(cov[i * n + i]));
        for (int j = 0; j < n; j++) {
            double scale = sqrt(cov[i * n + i] * cov[j * n + j]);
            gsl_matrix_set(correlation, (size_t)i, (size_t)j, cov[i * n + j] / scale);
        }
    }
    if (made) {
        *out = hotelling(correlation, pull, values, vectors, w, groups);
    }
    gsl_matrix_free(correlation);
    gsl_matrix_free(vectors);
    gsl_vector_free(values);
    gsl_vector_free(pull);
    gsl_eigen_symmv_free(w);
    return made ? SHEAR_OK : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a covariance");
}

/* ---- distributions ---- */

struct spread spread_of(const double *v, size_t n) {
    struct spread m = {.mean = 0.0};
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

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Q_KS(lambda): the alternating series where it converges fast, its theta-function twin elsewhere.
 */
static double kolmogorov_q(double lambda) {
    double sum = 0.0;
    if (lambda < 1.18) {
        double x = exp(-M_PI * M_PI / (8.0 * lambda * lambda));
        for (int k = 1; k < 20; k += 2) {
            sum += pow(x, k * k);
        }
        return lambda > 0.0 ? 1.0 - sqrt(2.0 * M_PI) / lambda * sum : 1.0;
    }
    for (int k = 1; k < 20; k++) {
        sum += (k % 2 ? 2.0 : -2.0) * exp(-2.0 * k * k * lambda * lambda);
    }
    return sum;
}

double ks_distance(double *v, size_t n, double nu, double *p) {
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(v[i])) {
            v[kept++] = v[i];
        }
    }
    qsort(v, kept, sizeof *v, by_value);
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

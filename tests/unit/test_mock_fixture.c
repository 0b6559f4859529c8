/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_mock_fixture.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdlib.h>

shear_mock *mock_of(const shear_mock_spec *spec) {
    shear_error err = {0};
    shear_mock *m = NULL;
    if (shear_mock_new(&m, spec, &err) != 0)
        fail_msg("%s", err.message);
    return m;
}

shear_mock *mock_with(const char *const *settings) {
    shear_mock_spec spec;
    shear_error err = {0};
    shear_mock_spec_init(&spec);
    for (; settings[0]; settings += 2) {
        if (shear_mock_set(&spec, settings[0], settings[1], &err) != 0)
            fail_msg("%s", err.message);
    }
    return mock_of(&spec);
}

double *doubles(size_t n) {
    double *v = calloc(n, sizeof *v);
    assert_non_null(v);
    return v;
}

void make_stamps(const shear_mock *m, int64_t first, int count, int threads, double **galaxy,
                 double **noise) {
    const shear_geometry *g = &shear_mock_get_info(m)->geometry;
    size_t n = (size_t)count * (size_t)g->nx * (size_t)g->ny;
    shear_error err = {0};
    *galaxy = doubles(n);
    *noise = doubles(n);
    if (shear_mock_stamps(m, first, count, threads, *galaxy, *noise, &err) != 0)
        fail_msg("%s", err.message);
}

double reference_psf(enum shear_mock_psf kind, double r, double angle, double dx, double dy) {
    double a = angle * M_PI / 180.0;
    double u = (cos(a) * dx + sin(a) * dy) / r;
    double v = (-sin(a) * dx + cos(a) * dy) / r;
    double w = exp(-0.5 * (u * u + 0.8 * v * v));
    if (kind == SHEAR_MOCK_PSF_B)
        w += 0.03 * exp(-(u * u + 0.2) * (v * v + 0.2));
    return w;
}

void check_close(double a, double b, double tolerance, const char *what, const char *file,
                 int line) {
    if (!(fabs(a - b) <= tolerance)) {
        print_error("%s:%d: %s is %.17g, not %.17g +- %.3g\n", file, line, what, a, b, tolerance);
        fail();
    }
}

double mean_of(const double *v, size_t n) {
    return gsl_stats_mean(v, 1, n);
}

double variance_of(const double *v, size_t n) {
    return gsl_stats_variance(v, 1, n);
}

double ks_of(double *v, size_t n, double (*cdf)(double, void *), void *context) {
    double d = 0.0;
    gsl_sort(v, 1, n);
    for (size_t i = 0; i < n; i++) {
        double p = cdf(v[i], context);
        d = fmax(d, fmax(p - (double)i / (double)n, (double)(i + 1) / (double)n - p));
    }
    return d * sqrt((double)n);
}

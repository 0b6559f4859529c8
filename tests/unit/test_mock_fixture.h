/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mocks, points and statistics for the tests of mocks/. */
#pragma once

#include "shear_mocks/mock.h"
#include "test.h"

/* A mock of `spec`; the test fails where there is none. */
shear_mock *mock_of(const shear_mock_spec *spec);
/* The same from the defaults and "name value" pairs, ended by NULL. */
shear_mock *mock_with(const char *const *settings);
#define MOCK(...) mock_with((const char *const[]){__VA_ARGS__, NULL})

/* Both stamps of [first, first+count); free both. */
void make_stamps(const shear_mock *m, int64_t first, int count, int threads, double **galaxy,
                 double **noise);

/* malloc that fails the test, zeros. */
double *doubles(size_t n);

/* Eq. (Ws), written down a second time: at (dx, dy) from the point, `angle` in degrees. */
double reference_psf(enum shear_mock_psf kind, double r, double angle, double dx, double dy);

/* cmocka's own comparison is in float. */
#define assert_close(a, b, tolerance) check_close(a, b, tolerance, #a, __FILE__, __LINE__)
void check_close(double a, double b, double tolerance, const char *what, const char *file,
                 int line);

double mean_of(const double *v, size_t n);
double variance_of(const double *v, size_t n);
/* Kolmogorov-Smirnov: sqrt(n) times the largest distance between the sample (sorted here) and the
 * CDF. */
double ks_of(double *v, size_t n, double (*cdf)(double, void *), void *context);

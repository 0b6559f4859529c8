/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The transfer T(k): its values, the isotropic cut, and the smallest beta. Seen through
 * shear_inspect. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "measure/transfer.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A plan's inspection of the pair. */
typedef struct view {
    shear_plan_info info;
    shear_inspection in;
} view;

static void look(const pair *p, view *v) {
    shear_plan *plan = NULL;
    shear_workspace *ws = NULL;
    shear_error err = {0};
    const shear_stamps stamps = {.count = 1,
                                 .nx = p->geometry.nx,
                                 .ny = p->geometry.ny,
                                 .galaxy = p->galaxy,
                                 .noise = p->noise};
    if (shear_plan_new(
            &plan,
            &(shear_plan_request){.settings = &p->settings, .geometry = p->geometry, .psf = p->psf},
            &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
    assert_int_equal(shear_workspace_new(&ws, plan, &err), SHEAR_OK);
    assert_int_equal(shear_inspect(plan, ws, &stamps, 0, &v->in, &err), SHEAR_OK);
    v->info = *shear_plan_get_info(plan);
    shear_workspace_free(ws);
    shear_plan_free(plan);
}

/* k of column x and row y of the spectra; the products and the sum round as the library's may not.
 */
static double k2_at(const view *v, int x, int y, double *kx, double *ky) {
    *kx = 2.0 * M_PI * (x - v->in.spec_nx / 2) / v->info.geometry.nx;
    *ky = 2.0 * M_PI * (y - v->in.spec_ny / 2) / v->info.geometry.ny;
    return *kx * *kx + *ky * *ky;
}

/* Strictly inside the cut, which is itself one of the modes' |k|: nothing lies within 1e-12 of it
 * but those modes. */
static bool inside(const view *v, double k2) {
    return k2 < v->info.k_cut * v->info.k_cut * (1.0 - 1e-12);
}

/* W of a top-hat of w samples, normalised. */
static double top_hat(double k, int w) {
    return k == 0.0 ? 1.0 : sin(0.5 * k * w) / (w * sin(0.5 * k));
}

/* A square top-hat is zero first at k = 2 pi / w on the axes. There the cut must fall, wherever
 * that mode is one of the stamp's, and inside it T = exp(-beta^2 k^2) / |W|^2. */
static void test_first_zero(void **state) {
    (void)state;
    for (int w = 3; w <= 6; w++) {
        for (int times = 4; times <= 7; times++) {
            const int n = w * times;
            pair p;
            view v;
            pair_init(&p, n, n, 17, 17, 1);
            pair_draw(&p, 1.0, 3);
            for (int i = 0; i < 17 * 17; i++) {
                p.psf[i] =
                    i % 17 >= 4 && i % 17 < 4 + w && i / 17 >= 5 && i / 17 < 5 + w ? 0.25 : 0.0;
            }
            pair_set(&p, "interpolation", "none");
            p.settings.beta_px = w;
            look(&p, &v);
            assert_near(v.info.k_cut, 2.0 * M_PI / w, 1e-14, 1.0, "k_cut");
            for (int i = 0; i < v.in.spec_nx * v.in.spec_ny; i++) {
                double kx;
                double ky;
                const double k2 = k2_at(&v, i % v.in.spec_nx, i / v.in.spec_nx, &kx, &ky);
                const double amplitude = top_hat(kx, w) * top_hat(ky, w);
                const double beta2 = p.settings.beta_px * p.settings.beta_px;
                const double expected =
                    inside(&v, k2) ? exp(-beta2 * k2) / (amplitude * amplitude) : 0.0;
                assert_near(v.in.transfer[i], expected, 1e-9, expected, "T");
            }
            shear_inspection_deinit(&v.in);
            pair_deinit(&p);
        }
    }
}

/* |W|^2 of a PSF at one mode, by its sum. */
static double psf_power(const pair *p, double kx, double ky) {
    double re = 0.0;
    double im = 0.0;
    double sum = 0.0;
    for (int i = 0; i < p->geometry.psf_nx * p->geometry.psf_ny; i++) {
        const double phase = kx * (i % p->geometry.psf_nx) + ky * (i / p->geometry.psf_nx);
        re += p->psf[i] * cos(phase);
        im += p->psf[i] * sin(phase);
        sum += p->psf[i];
    }
    return (re * re + im * im) / (sum * sum);
}

/* The last |k|^2 inside the cut at which k^4 T is more than 1e-15 of its largest value. */
static double reach2_of(const pair *p, const view *v, double beta) {
    double most = 0.0;
    double reach2 = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < v->in.spec_nx * v->in.spec_ny; i++) {
            double kx;
            double ky;
            const double k2 = k2_at(v, i % v->in.spec_nx, i / v->in.spec_nx, &kx, &ky);
            const double weight =
                inside(v, k2) ? k2 * k2 * exp(-beta * beta * k2) / psf_power(p, kx, ky) : 0.0;
            most = fmax(most, weight);
            reach2 = pass == 1 && weight > 1e-15 * most ? fmax(reach2, k2) : reach2;
        }
    }
    return reach2;
}

/* Random PSFs, most of whose first weak mode lies off the axes: it is cut itself, with all at its
 * |k| and beyond, and none before it but what is nothing; 1/T never exceeds what the threshold
 * allows. */
static void test_cut_is_isotropic(void **state) {
    (void)state;
    uint64_t seed = 31;
    for (int k = 0; k < 60; k++) {
        pair p;
        view v;
        pair_init(&p, 18 + k % 3, 20, 7, 7, 1);
        pair_draw(&p, 1.0, 5);
        for (int i = 0; i < 49; i++) {
            p.psf[i] = exp(-0.1 * ((i % 7 - 3) * (i % 7 - 3) + (i / 7 - 3) * (i / 7 - 3))) *
                       (0.2 + uniform(&seed));
        }
        pair_set(&p, "interpolation", "none");
        pair_set(&p, "psf-threshold", "0.01");
        pair_set(&p, "beta", "9");
        look(&p, &v);
        double cut2 = M_PI * M_PI;
        for (int i = 0; i < v.in.spec_nx * v.in.spec_ny; i++) {
            double kx;
            double ky;
            const double k2 = k2_at(&v, i % v.in.spec_nx, i / v.in.spec_nx, &kx, &ky);
            cut2 = psf_power(&p, kx, ky) < 0.01 ? fmin(cut2, k2) : cut2;
        }
        assert_near(v.info.k_cut, sqrt(cut2), 1e-15, 4.0, "k_cut");
        const double reach2 = reach2_of(&p, &v, 9.0) * (1.0 + 1e-12);
        for (int i = 0; i < v.in.spec_nx * v.in.spec_ny; i++) {
            double kx;
            double ky;
            const double k2 = k2_at(&v, i % v.in.spec_nx, i / v.in.spec_nx, &kx, &ky);
            assert_true((v.in.transfer[i] > 0.0) == (inside(&v, k2) && k2 <= reach2));
        }
        shear_inspection_deinit(&v.in);
        pair_deinit(&p);
    }
}

/* 25 = 5^2 + 0^2 = 3^2 + 4^2, and many numbers are sums of two squares in more ways than one: modes
 * of the same |k|, whose k^2 rounds differently. The cut takes all of them or none. */
static void test_modes_of_the_same_k(void **state) {
    (void)state;
    enum { N = 130 };
    uint64_t seed = 7;
    for (int k = 0; k < 40; k++) {
        pair p;
        view v;
        double least[N * N / 2 + 1]; /* of T, by the integer norm */
        double most[N * N / 2 + 1];
        pair_init(&p, N, N, 7, 7, 1);
        pair_draw(&p, 1.0, 5);
        for (int i = 0; i < 49; i++) {
            p.psf[i] = exp(-0.1 * ((i % 7 - 3) * (i % 7 - 3) + (i / 7 - 3) * (i / 7 - 3))) *
                       (0.2 + uniform(&seed));
        }
        pair_set(&p, "interpolation", "none");
        pair_set(&p, "psf-threshold", k % 2 == 0 ? "0.01" : "0.1");
        pair_set(&p, "beta", "9");
        look(&p, &v);
        for (int i = 0; i <= N * N / 2; i++) {
            least[i] = INFINITY;
            most[i] = 0.0;
        }
        for (int i = 0; i < v.in.spec_nx * v.in.spec_ny; i++) {
            const int x = i % v.in.spec_nx - v.in.spec_nx / 2;
            const int y = i / v.in.spec_nx - v.in.spec_ny / 2;
            const int norm = x * x + y * y;
            least[norm] = fmin(least[norm], v.in.transfer[i]);
            most[norm] = fmax(most[norm], v.in.transfer[i]);
        }
        for (int i = 0; i <= N * N / 2; i++)
            assert_true(least[i] == INFINITY || (least[i] > 0.0) == (most[i] > 0.0));
        shear_inspection_deinit(&v.in);
        pair_deinit(&p);
    }
}

static double weight(double k, void *beta) {
    const double b = *(double *)beta;
    return pow(k, 5.0) * exp(-b * b * k * k);
}

/* The part of sum k^4 exp(-beta^2 k^2) beyond k_cut, by numerical integration over the plane. */
static void test_power_beyond(void **state) {
    (void)state;
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(200);
    for (double beta = 0.4; beta < 5.0; beta *= 1.7) {
        for (double x = 0.0; x < 6.0; x += 0.8) {
            double all;
            double beyond;
            double error;
            const double k_cut = x / beta;
            gsl_function f = {.function = weight, .params = &beta};
            gsl_integration_qagiu(&f, 0.0, 0.0, 1e-11, 200, w, &all, &error);
            gsl_integration_qagiu(&f, k_cut, 0.0, 1e-11, 200, w, &beyond, &error);
            assert_near(transfer_power_beyond(beta, k_cut), beyond / all, 1e-9, beyond / all,
                        "part beyond");
        }
    }
    gsl_integration_workspace_free(w);
}

static void test_smallest_beta(void **state) {
    (void)state;
    for (double k_cut = 0.1; k_cut < 60.0; k_cut *= 1.9) {
        for (double tolerance = 1e-6; tolerance < 0.9; tolerance *= 7.0) {
            const double beta = transfer_smallest_beta(k_cut, tolerance);
            assert_true(transfer_power_beyond(beta, k_cut) <= tolerance);
            assert_true(transfer_power_beyond(beta - 1.01e-4, k_cut) > tolerance);
        }
    }
    assert_true(transfer_smallest_beta(3.0, 1.0) <= 1e-4);
    assert_true(transfer_power_beyond(transfer_smallest_beta(3.0, 0.0), 3.0) == 0.0);
    assert_true(isinf(transfer_smallest_beta(0.0, 1e-3)));
}

/* The error names the smallest beta; that works, and a little less does not. */
static void check_advice(pair *p, double r_psf) {
    shear_error err = {0};
    shear_plan *plan = NULL;
    const double *psf = r_psf > 0.0 ? NULL : p->psf;
    p->settings.beta_px = 0.05;
    assert_int_equal(shear_plan_new(&plan,
                                    &(shear_plan_request){.settings = &p->settings,
                                                          .geometry = p->geometry,
                                                          .psf = psf,
                                                          .r_psf_px = r_psf},
                                    &err),
                     SHEAR_E_BETA);
    assert_null(plan);
    assert_non_null(strstr(err.advice, "larger beta"));
    const char *number = strstr(err.message, "works is ");
    assert_non_null(number);
    p->settings.beta_px = strtod(number + strlen("works is "), NULL);
    assert_true(p->settings.beta_px > 0.05);
    assert_int_equal(shear_plan_new(&plan,
                                    &(shear_plan_request){.settings = &p->settings,
                                                          .geometry = p->geometry,
                                                          .psf = psf,
                                                          .r_psf_px = r_psf},
                                    &err),
                     SHEAR_OK);
    shear_plan_free(plan);
    p->settings.beta_px -= 1.01e-4;
    assert_int_equal(shear_plan_new(&plan,
                                    &(shear_plan_request){.settings = &p->settings,
                                                          .geometry = p->geometry,
                                                          .psf = psf,
                                                          .r_psf_px = r_psf},
                                    &err),
                     SHEAR_E_BETA);
}

static void test_beta_too_small(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m++) {
        pair p;
        pair_init(&p, 24, 25, 15, 15, 1);
        pair_draw(&p, 0.9, 5);
        pair_set(&p, "interpolation", pair_methods[m]);
        check_advice(&p, 0.0);
        check_advice(&p, 0.9); /* one PSF a stamp: the grid's own limit */
        pair_deinit(&p);
    }
}

/* A PSF that a log method cannot take. OVERSAMP 1 has to be interpolated, a fine one not. What
 * rounding leaves below zero counts as zero. */
static void test_negative_psf(void **state) {
    (void)state;
    pair p;
    shear_row row;
    shear_error err = {0};
    pair_init(&p, 24, 24, 15, 15, 1);
    pair_draw(&p, 0.9, 5);
    pair_set(&p, "interpolation", "log-bicubic");
    shear_row with_zero;
    p.psf[2 * 15 + 4] = 0.0;
    assert_int_equal(pair_try(&p, &with_zero, &err), SHEAR_OK);
    double peak = 0.0;
    for (int i = 0; i < 15 * 15; i++)
        peak = fmax(peak, p.psf[i]);
    p.psf[2 * 15 + 4] = -0.9e-4 * peak;
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_OK);
    assert_same_rows(&row, &with_zero, 1);
    p.psf[2 * 15 + 4] = -1.1e-4 * peak;
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_NEGATIVE);
    assert_non_null(strstr(err.message, "(5, 3)"));
    assert_true(err.advice[0] != '\0');
    pair_set(&p, "interpolation", "bicubic");
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_OK);
    pair_set(&p, "interpolation", "log-bicubic");
    p.geometry.psf_oversample = 4;
    pair_set(&p, "beta", "0.5");
    pair_set(&p, "oversample", "4");
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_OK);
    pair_deinit(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_zero),          cmocka_unit_test(test_cut_is_isotropic),
        cmocka_unit_test(test_modes_of_the_same_k), cmocka_unit_test(test_power_beyond),
        cmocka_unit_test(test_smallest_beta),       cmocka_unit_test(test_beta_too_small),
        cmocka_unit_test(test_negative_psf),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

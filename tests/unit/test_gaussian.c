/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gaussian galaxies and PSFs: every moment is known in closed form. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/settings.h"

#include <math.h>

static void check(int nx, int ny, const gaussian *galaxy, const gaussian *psf, int psf_n,
                  int oversample, const char *interpolation, double tolerance) {
    pair p;
    shear_plan_info info;
    pair_init(&p, nx, ny, psf_n, psf_n, oversample);
    assert_int_equal(shear_settings_set(&p.settings, "interpolation", interpolation, NULL),
                     SHEAR_OK);
    gaussian_draw(galaxy, nx, ny, 1, p.galaxy);
    gaussian_draw(psf, psf_n, psf_n, oversample, p.psf);
    const shear_row measured = pair_measure_info(&p, &info);
    const shear_row exact = gaussian_row(galaxy, psf, info.beta_px);
    assert_rows_near(&measured, &exact, tolerance);
    pair_deinit(&p);
}

static const gaussian psf = {
    .amplitude = 1.0, .xx = 2.4, .yy = 2.0, .xy = 0.3, .x0 = 24.3, .y0 = 23.8};
static const gaussian galaxy = {
    .amplitude = 7.0, .xx = 11.0, .yy = 8.0, .xy = -1.5, .x0 = 31.7, .y0 = 30.9};

static void test_well_sampled(void **state) {
    (void)state;
    check(64, 64, &galaxy, &psf, 48, 1, "none", 1e-8);
}

static void test_odd_and_rectangular(void **state) {
    (void)state;
    check(65, 63, &galaxy, &psf, 47, 1, "none", 1e-8);
    gaussian wide = galaxy;
    wide.x0 = 45.2;
    check(96, 60, &wide, &psf, 48, 1, "none", 1e-8);
    wide.x0 = 30.0;
    wide.y0 = 50.1;
    check(61, 101, &wide, &psf, 48, 1, "none", 1e-8);
}

/* The PSF image may be larger than the stamp; at the stamp's modes nothing is lost. */
static void test_psf_larger_than_stamp(void **state) {
    (void)state;
    gaussian centred = psf;
    centred.x0 = centred.y0 = 48.0;
    check(64, 64, &galaxy, &centred, 97, 1, "none", 1e-8);
}

static void test_oversampled_psf(void **state) {
    (void)state;
    gaussian small = psf;
    small.x0 = small.y0 = 16.0;
    check(64, 64, &galaxy, &small, 161, 5, "none", 1e-8);
}

/* A Gaussian's logarithm is a quadratic: log-bicubic is exact but for the border, where the
 * derivatives are one-sided, and log-spline but for the ends' f'' = 0; both lie at 1e-8 of the
 * peak. */
static void test_log_methods(void **state) {
    (void)state;
    gaussian small = psf;
    small.x0 = small.y0 = 16.0;
    check(64, 64, &galaxy, &small, 161, 5, "log-bicubic", 1e-7);
    check(64, 64, &galaxy, &small, 161, 5, "log-spline", 1e-7);
    check(64, 64, &galaxy, &psf, 48, 1, "log-bicubic", 1e-7);
    check(64, 64, &galaxy, &psf, 48, 1, "log-spline", 1e-5);
}

static const gaussian sharp = {.amplitude = 1.0, .xx = 0.25, .yy = 0.25, .x0 = 7.0, .y0 = 7.0};
static const gaussian compact = {
    .amplitude = 3.0, .xx = 0.7, .yy = 0.5, .xy = 0.1, .x0 = 15.7, .y0 = 16.2};

/* An under-sampled pair, R_PSF = 0.5 px: of one stamp, only the log methods can know what lies
 * between the pixels. */
static void test_under_sampled(void **state) {
    (void)state;
    check(32, 32, &compact, &sharp, 15 * 16 + 1, 16, "log-bicubic", 1e-6);
    check(32, 32, &compact, &sharp, 15 * 16 + 1, 16, "paper", 1e-6);
}

/* g1 of a round galaxy 1.5 times as large as the PSF, sheared by g, in stamps of n px. */
static double shear_in_stamps_of(int nx, int ny, double g, shear_plan_info *info) {
    enum { PSF = 21 };
    const double r2 = 1.2 * 1.2;
    const double s2 = 2.25 * r2;
    const gaussian round = {.amplitude = 1.0, .xx = r2, .yy = r2, .x0 = 10.0, .y0 = 10.0};
    const gaussian sheared = {.amplitude = 1.0,
                              .xx = s2 * (1.0 + g) * (1.0 + g) + r2,
                              .yy = s2 * (1.0 - g) * (1.0 - g) + r2,
                              .x0 = 0.5 * nx - 0.2,
                              .y0 = 0.5 * ny - 0.6};
    pair p;
    pair_init(&p, nx, ny, PSF, PSF, 1);
    gaussian_draw(&sheared, nx, ny, 1, p.galaxy);
    gaussian_draw(&round, PSF, PSF, 1, p.psf);
    const shear_row row = pair_measure_info(&p, info);
    pair_deinit(&p);
    return row.n1 / row.d;
}

/* What stamps that are small for beta do to the shear is what the plan says: 0.1 % of it with sides
 * of 10 beta, 3 % with 8, 6 % with 7.5. */
static void test_small_stamps(void **state) {
    (void)state;
    static const struct {
        int nx, ny;
        double least, most;
    } cases[] = {
        {18, 18, 0.05, 0.1}, {19, 19, 0.02, 0.04}, {24, 24, 0.0, 1e-3}, {19, 32, 0.005, 0.04}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        shear_plan_info info;
        const double plus = shear_in_stamps_of(cases[i].nx, cases[i].ny, 0.02, &info);
        const double minus = shear_in_stamps_of(cases[i].nx, cases[i].ny, -0.02, &info);
        const double bias = fmax(fabs((plus - minus) / 0.04 - 1.0), fabs(0.5 * (plus + minus)));
        assert_true(bias >= cases[i].least && bias <= cases[i].most);
        assert_near(shear_plan_periodic_bias(&info), bias, 0.02, bias + 0.02, "bias");
    }
}

static void add_moments(shear_row *sum, const shear_row *row, double weight) {
    sum->m20 += weight * row->m20;
    sum->m02 += weight * row->m02;
    sum->m11 += weight * row->m11;
    sum->m4 += weight * row->m4;
    sum->u += weight * row->u;
    sum->v += weight * row->v;
    sum->n1 += weight * row->n1;
    sum->n2 += weight * row->n2;
    sum->d += weight * row->d;
}

/* Over sub-pixel positions the aliases' cross terms with the signal average out, and what is left
 * of them is their power under the target: 1e-5 of m4 at beta-floor. */
static void test_positions_average_aliases(void **state) {
    (void)state;
    enum { STEPS = 4, N = 15 * 16 + 1 };
    shear_row mean = {0};
    shear_row one = {0};
    shear_plan_info info;
    pair p;
    pair_init(&p, 32, 32, N, N, 16);
    gaussian_draw(&sharp, N, N, 16, p.psf);
    for (int i = 0; i < STEPS * STEPS; i++) {
        gaussian moved = compact;
        moved.x0 += (double)(i % STEPS) / STEPS;
        moved.y0 += (double)(i / STEPS) / STEPS;
        gaussian_draw(&moved, 32, 32, 1, p.galaxy);
        one = pair_measure_info(&p, &info);
        add_moments(&mean, &one, 1.0 / (STEPS * STEPS));
    }
    const shear_row exact = gaussian_row(&compact, &sharp, info.beta_px);
    assert_int_equal(info.interpolation, SHEAR_INTERP_NONE);
    assert_true(info.beta_px == 1.4);
    assert_rows_near(&mean, &exact, 2e-5);
    assert_true(fabs(one.m20 - exact.m20) > 1e-4 * exact.m20);
    pair_deinit(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_well_sampled),
        cmocka_unit_test(test_odd_and_rectangular),
        cmocka_unit_test(test_psf_larger_than_stamp),
        cmocka_unit_test(test_oversampled_psf),
        cmocka_unit_test(test_log_methods),
        cmocka_unit_test(test_under_sampled),
        cmocka_unit_test(test_small_stamps),
        cmocka_unit_test(test_positions_average_aliases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a plan chooses for settings that are auto, and what it refuses. Without a PSF image its
 * radius is given exactly. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <string.h>

static shear_plan_info decide(const shear_settings *settings, const shear_geometry *geometry,
                              double r_psf) {
    shear_plan *plan = NULL;
    shear_error err = {0};
    if (shear_plan_new(
            &plan,
            &(shear_plan_request){.settings = settings, .geometry = *geometry, .r_psf_px = r_psf},
            &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
    const shear_plan_info info = *shear_plan_get_info(plan);
    assert_memory_equal(shear_plan_get_settings(plan), settings, sizeof *settings);
    shear_plan_free(plan);
    return info;
}

/* An interpolation and s, for PSFs of `given` samples a pixel. */
static shear_plan_info sampling(const char *method, const char *oversample, double r_psf,
                                int given) {
    const shear_geometry geometry = {
        .nx = 12, .ny = 10, .psf_nx = 9, .psf_ny = 9, .psf_oversample = given};
    shear_settings settings;
    shear_settings_init(&settings);
    shear_settings_set(&settings, "interpolation", method, NULL);
    shear_settings_set(&settings, "oversample", oversample, NULL);
    const shear_plan_info info = decide(&settings, &geometry, r_psf);
    assert_int_equal(info.fine_nx, 12 * info.oversample);
    assert_int_equal(info.fine_ny, 10 * info.oversample);
    assert_true(info.r_psf_px == r_psf && info.beta_px == fmax(2.0 * r_psf, 1.4));
    return info;
}

/* Paper: none from R_PSF = 1 px, log-bicubic below, or where something asks for interpolation.
 * Auto: none also below. */
static void test_method(void **state) {
    (void)state;
    assert_int_equal(sampling("paper", "auto", 1.0, 1).interpolation, SHEAR_INTERP_NONE);
    assert_int_equal(sampling("paper", "auto", 0.9999, 1).interpolation, SHEAR_INTERP_LOG_BICUBIC);
    assert_int_equal(sampling("paper", "auto", 0.5, 4).interpolation, SHEAR_INTERP_LOG_BICUBIC);
    assert_int_equal(sampling("paper", "4", 2.0, 1).interpolation, SHEAR_INTERP_LOG_BICUBIC);
    assert_int_equal(sampling("auto", "auto", 1.0, 1).interpolation, SHEAR_INTERP_NONE);
    assert_int_equal(sampling("auto", "auto", 0.5, 2).interpolation, SHEAR_INTERP_NONE);
    assert_int_equal(sampling("auto", "auto", 0.5, 1).interpolation, SHEAR_INTERP_NONE);
    assert_int_equal(sampling("auto", "4", 0.5, 2).interpolation, SHEAR_INTERP_LOG_BICUBIC);
    assert_int_equal(sampling("auto", "4", 2.0, 1).interpolation, SHEAR_INTERP_LOG_BICUBIC);
    assert_int_equal(sampling("auto", "1", 2.0, 1).interpolation, SHEAR_INTERP_NONE);
    assert_int_equal(sampling("spline", "auto", 2.0, 1).interpolation, SHEAR_INTERP_SPLINE);
    const shear_geometry geometry = {
        .nx = 12, .ny = 10, .psf_nx = 9, .psf_ny = 9, .psf_oversample = 1};
    shear_settings settings;
    shear_settings_init(&settings);
    settings.pedestal = 1.0;
    assert_int_equal(decide(&settings, &geometry, 2.0).interpolation, SHEAR_INTERP_LOG_BICUBIC);
}

/* A beta of one's own below 1.2 px needs modes beyond the pixels' own. */
static void test_small_beta(void **state) {
    (void)state;
    const shear_geometry geometry = {
        .nx = 12, .ny = 10, .psf_nx = 9, .psf_ny = 9, .psf_oversample = 4};
    shear_settings settings;
    shear_settings_init(&settings);
    settings.beta_px = 1.2;
    assert_int_equal(decide(&settings, &geometry, 0.5).interpolation, SHEAR_INTERP_NONE);
    settings.beta_px = 1.1999;
    assert_int_equal(decide(&settings, &geometry, 0.5).interpolation, SHEAR_INTERP_LOG_BICUBIC);
    assert_int_equal(decide(&settings, &geometry, 1.0).interpolation, SHEAR_INTERP_NONE);
}

/* The smallest s = 2^m with 1/s < R_PSF/4, strictly; none is never finer than the pixels. */
static void test_oversampling(void **state) {
    (void)state;
    static const struct {
        double r_psf;
        int s;
    } cases[] = {{4.1, 1}, {4.0, 2}, {2.01, 2}, {2.0, 4},    {1.01, 4},
                 {1.0, 8}, {0.8, 8}, {0.5, 16}, {0.251, 16}, {0.25, 32}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(sampling("bicubic", "auto", cases[i].r_psf, 1).oversample, cases[i].s);
        assert_int_equal(sampling("none", "auto", fmax(1.0, cases[i].r_psf), 1).oversample, 1);
        assert_int_equal(sampling("bicubic", "8", fmax(0.5, cases[i].r_psf), 1).oversample, 8);
    }
}

/* The PSF: refined like the stamps where it is as coarse as they are, or so coarse that its samples
 * lie wider apart than its radius; else taken as it is. */
static void test_psf_sampling(void **state) {
    (void)state;
    assert_int_equal(sampling("spline", "auto", 0.5, 1).psf_oversample, 16);
    assert_int_equal(sampling("spline", "auto", 0.5, 2).psf_oversample,
                     2); /* one radius a sample */
    assert_int_equal(sampling("spline", "auto", 0.49, 2).psf_oversample, 16);
    assert_int_equal(sampling("spline", "auto", 0.3, 3).psf_oversample, 24); /* 3 times 8 >= 16 */
    assert_int_equal(sampling("spline", "auto", 0.5, 20).psf_oversample, 20);
    assert_int_equal(sampling("none", "auto", 1.5, 1).psf_oversample, 1);
    assert_int_equal(sampling("none", "auto", 1.5, 5).psf_oversample, 5);
}

static void test_beta(void **state) {
    (void)state;
    const shear_geometry geometry = {
        .nx = 12, .ny = 10, .psf_nx = 9, .psf_ny = 9, .psf_oversample = 1};
    shear_settings settings;
    shear_settings_init(&settings);
    settings.beta_ratio = 2.25;
    assert_true(decide(&settings, &geometry, 2.0).beta_px == 4.5);
    settings.beta_floor_px = 4.75;
    assert_true(decide(&settings, &geometry, 2.0).beta_px == 4.75);
    assert_true(decide(&settings, &geometry, 3.0).beta_px == 6.75);
    settings.beta_px = 3.5;
    assert_true(decide(&settings, &geometry, 2.0).beta_px == 3.5);
}

static void check_refused(const shear_geometry *geometry, const char *oversample, double r_psf,
                          int code, const char *word) {
    shear_settings settings;
    shear_error err = {0};
    shear_plan *plan = (shear_plan *)&settings;
    shear_settings_init(&settings);
    shear_settings_set(&settings, "interpolation", "bilinear", NULL);
    shear_settings_set(&settings, "oversample", oversample, NULL);
    assert_int_equal(
        shear_plan_new(
            &plan,
            &(shear_plan_request){.settings = &settings, .geometry = *geometry, .r_psf_px = r_psf},
            &err),
        code);
    assert_null(plan);
    assert_non_null(strstr(err.message, word));
    assert_int_equal(
        shear_plan_new(
            &plan,
            &(shear_plan_request){.settings = &settings, .geometry = *geometry, .r_psf_px = r_psf},
            NULL),
        code);
}

static void test_refusals(void **state) {
    (void)state;
    const shear_geometry small = {
        .nx = 12, .ny = 10, .psf_nx = 9, .psf_ny = 9, .psf_oversample = 1};
    shear_geometry large = {.nx = 1024, .ny = 1024, .psf_nx = 9, .psf_ny = 9, .psf_oversample = 1};
    static const double bad_radii[] = {NAN, 0.0, -1.0, INFINITY};
    for (int i = 0; i < 4; i++)
        check_refused(&small, "auto", bad_radii[i], SHEAR_E_PSF, "scale radius");
    check_refused(&small, "auto", 1e-3, SHEAR_E_SETTING, "too large"); /* s ends at 1024 */
    check_refused(&large, "16", 1.0, SHEAR_E_SETTING, "too large");
    large.psf_nx = large.psf_ny = 3000;
    check_refused(&large, "4", 1.0, SHEAR_E_PSF, "3000 x 3000");
    large.psf_nx = large.psf_ny = 9;
    large.psf_oversample = 400;
    check_refused(&large, "2", 1.0, SHEAR_E_PSF, "400 per pixel");
    shear_plan_free(NULL);
    shear_workspace_free(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_method),       cmocka_unit_test(test_oversampling),
        cmocka_unit_test(test_psf_sampling), cmocka_unit_test(test_beta),
        cmocka_unit_test(test_refusals),     cmocka_unit_test(test_small_beta),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

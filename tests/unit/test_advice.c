/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Advice about results: thresholds, the direction of changes, and a separate name for each reason
 * of no shear. */
#include "test.h"

#include "sheard/advice.h"
#include "sheard/no_shear.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static char text[SHEARD_ADVICE_SIZE];

static const shear_plan_info plan = {
    .interpolation = SHEAR_INTERP_NONE, .r_psf_px = 1.6, .noise_band = SHEAR_NOISE_BAND_HIGH};

/* A result about which there is nothing to say. */
static shear_result sound(void) {
    return (shear_result){.valid = true,
                          .n_stamps = 1000,
                          .n_used = 1000,
                          .n_eff = 700.0,
                          .top_share = 0.01,
                          .top_stamp = 7,
                          .sum_d = 10.0,
                          .signal = 50.0,
                          .noise_level = 1.0,
                          .noise_level_err = 0.001,
                          .noise_effect = 0.0,
                          .noise_shape = 0.0,
                          .noise_shape_err = 0.001,
                          .noise_share = 1.0,
                          .g1_err = 0.01,
                          .g2_err = 0.01,
                          .delta_g1_err = 0.01,
                          .delta_g2_err = 0.01};
}

static const char *level_advice(double level, double err, double share) {
    shear_result r = sound();
    r.noise_level = level;
    r.noise_level_err = err;
    r.noise_share = share;
    r.noise_effect = (level - 1.0) * share;
    return sheard_advice_noise_level(&r, &plan, text, sizeof text);
}

static void a_noise_level_that_matters(void **state) {
    (void)state;
    assert_non_null(level_advice(1.041, 0.003, 15.0));
    assert_non_null(strstr(text, "4.1 +- 0.3 % stronger"));
    /* (alpha - 1) share = 0.615: what is measured is 1/1.615 of the shear */
    assert_non_null(strstr(text, "the shear would be 38 % too small"));
    assert_non_null(level_advice(0.96, 0.003, 5.0));
    assert_non_null(strstr(text, "4.0 +- 0.3 % weaker"));
    assert_non_null(strstr(text, "the shear would be 25 % too large"));
    assert_non_null(level_advice(0.96, 0.003, 24.0)); /* D would have a 25th left */
    assert_non_null(strstr(text, "there would be no shear"));
    assert_null(level_advice(1.009, 0.001, 15.0));
    assert_null(level_advice(1.041, 0.011, 15.0));
    assert_null(level_advice(1.041, 0.003, 0.04));
    assert_null(level_advice(NAN, NAN, 15.0));
    assert_non_null(level_advice(0.25, 0.001, 1.0));
    assert_non_null(strstr(text, "not of the galaxies' noise"));
    assert_null(strstr(text, "photons"));
}

static void a_noise_level_that_cannot_be_checked(void **state) {
    (void)state;
    shear_result r = sound();
    shear_plan_info narrow = plan;
    narrow.r_psf_px = 0.6;
    assert_null(sheard_advice_noise_unchecked(&r, &narrow, text, sizeof text));
    r.noise_level = NAN;
    r.noise_share = 11.0;
    assert_non_null(sheard_advice_noise_unchecked(&r, &narrow, text, sizeof text));
    assert_non_null(strstr(text, "R_PSF is only 0.6 px"));
    assert_non_null(strstr(text, "9.9 % too small")); /* 0.11 / 1.11 */
    r.noise_share = 0.4;
    assert_null(sheard_advice_noise_unchecked(&r, &narrow, text, sizeof text));
    r.noise_share = 11.0;
    assert_null(sheard_advice_noise_unchecked(&r, &plan, text, sizeof text)); /* asked for */
    narrow = plan;
    narrow.interpolation = SHEAR_INTERP_LOG_BICUBIC;
    assert_non_null(sheard_advice_noise_unchecked(&r, &narrow, text, sizeof text));
    assert_non_null(strstr(text, "interpolated"));
}

/* D of white noise behind a Gaussian PSF of R = 1.5 px, beta = 3 px, in 48 x 48 px, variance 9:
 * -2304 9 2.25 / (4 pi 6.75^3) = -12.07 a stamp. */
static void noise_stamps_without_noise(void **state) {
    (void)state;
    const shear_plan_info wide = {.interpolation = SHEAR_INTERP_NONE,
                                  .r_psf_px = 1.5,
                                  .beta_px = 3.0,
                                  .geometry = {.nx = 48, .ny = 48}};
    shear_result r = sound();
    sheard_cause cause;
    r.noise_level = r.noise_level_err = r.noise_shape = r.noise_shape_err = NAN;
    r.noise_share = 0.0;
    r.sum_weight = 1000.0;
    r.sum_d = 1000.0 * (60.0 - 12.07);
    r.border_rough = 9.0;
    r.border_rough_err = 0.1;
    r.high_galaxy = NAN;
    assert_true(fabs(sheard_advice_noise_left(&r, &wide) + 12.07 / 60.0) < 1e-4);
    r.high_galaxy = 9.0;
    assert_true(fabs(sheard_advice_noise_left(&r, &wide) + 12.07 / 60.0) < 1e-4);
    assert_non_null(sheard_advice_no_noise(&r, &wide, text, sizeof text));
    assert_non_null(strstr(text, "25 % too large")); /* 60/(60 - 12) */
    assert_null(sheard_advice_rough_border(&r, &wide, text, sizeof text));
    assert_true(sheard_cause_of(&r, &wide, &cause));
    r.high_galaxy = 0.01; /* what is rough on the borders is not noise */
    assert_null(sheard_advice_no_noise(&r, &wide, text, sizeof text));
    assert_false(sheard_cause_of(&r, &wide, &cause));
    r.high_galaxy = NAN;
    r.border_excess = 2.0; /* wings */
    assert_true(sheard_advice_noise_left(&r, &wide) == 0.0);
    r.border_excess = 0.0;
    r.border_noise_var = 9.0; /* the correction was switched off */
    assert_true(sheard_advice_noise_left(&r, &wide) == 0.0);
    r.border_noise_var = 0.0;
    r.noise_share = -0.1; /* there is noise, and it is taken off */
    assert_true(sheard_advice_noise_left(&r, &wide) == 0.0);
    r.noise_share = 0.0;
    r.noise_level = 3.0; /* likewise */
    assert_true(sheard_advice_noise_left(&r, &wide) == 0.0);
}

static const char *shape_advice(double shape, double err, double share) {
    shear_result r = sound();
    r.noise_shape = shape;
    r.noise_shape_err = err;
    r.noise_share = share;
    r.noise_level = 1.5;
    r.noise_effect = 0.5 * share;
    const char *line = sheard_advice_noise_shape(&r, &plan, text, sizeof text);
    char other[SHEARD_ADVICE_SIZE];
    /* Then the level is no cure, and is not told as one. */
    assert_true((line == NULL) ==
                (sheard_advice_noise_level(&r, &plan, other, sizeof other) != NULL));
    return line;
}

static void another_spectrum(void **state) {
    (void)state;
    assert_non_null(shape_advice(-0.4, 0.01, 1.0));
    assert_non_null(strstr(text, "40 +- 1 % weaker"));
    assert_non_null(strstr(text, "correlated"));
    assert_null(shape_advice(0.02, 0.001, 1.0));
    assert_null(shape_advice(0.4, 0.09, 1.0));
    assert_null(shape_advice(0.04, 0.001, 0.02));
    assert_null(shape_advice(NAN, NAN, 1.0));
}

static const char *influence(double share, double n_eff, int64_t n_used, const char *file) {
    shear_result r = sound();
    r.top_share = share;
    r.n_eff = n_eff;
    r.n_used = n_used;
    return sheard_advice_influence(&r, file, text, sizeof text);
}

static void one_stamp_decides(void **state) {
    (void)state;
    assert_non_null(influence(0.62, 2.5, 64, NULL));
    assert_non_null(strstr(text, "stamp 7 has 62 %"));
    assert_non_null(strstr(text, "--stamp 7"));
    assert_non_null(influence(0.62, 2.5, 64, "b.fits"));
    assert_non_null(strstr(text, "stamp 7 of b.fits has"));
    assert_null(influence(0.09, 90.0, 1000, NULL));
    assert_null(influence(0.12, 35.0, 40, NULL)); /* 5 times the part of one of 40 is 0.125 */
    assert_non_null(influence(0.13, 35.0, 40, NULL));
    assert_non_null(influence(0.09, 9.9, 51, NULL));
    assert_null(influence(0.09, 9.9, 50, NULL));
    assert_null(influence(NAN, 90.0, 1000, NULL));
    shear_result counted = sound(); /* a bright stamp counts no more than others */
    counted.top_share = 0.9;
    counted.estimator = SHEAR_ESTIMATOR_PDF_SYM;
    assert_null(sheard_advice_influence(&counted, NULL, text, sizeof text));
}

static void a_long_name_is_cut(void **state) {
    char name[5000];
    (void)state;
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    assert_non_null(influence(0.62, 2.5, 64, name));
    assert_non_null(strstr(text, "--estimator pdf-sym"));
}

static void one_stamp_decides_the_level(void **state) {
    (void)state;
    shear_result r = sound();
    assert_null(sheard_advice_noise_scatter(&r, &plan, text, sizeof text));
    r.noise_level = 700.0;
    r.noise_level_err = 690.0;
    r.noise_share = 1e-4;
    assert_non_null(sheard_advice_noise_scatter(&r, &plan, text, sizeof text));
    assert_non_null(strstr(text, "stamp 7"));
    r.noise_share = 1e-6;
    assert_null(sheard_advice_noise_scatter(&r, &plan, text, sizeof text));
}

static const char *errors(double ratio1, double ratio2, int groups) {
    shear_result r = sound();
    r.g1_err = ratio1 * r.delta_g1_err;
    r.g2_err = ratio2 * r.delta_g2_err;
    r.jackknife = groups;
    return sheard_advice_errors(&r, &plan, text, sizeof text);
}

static void errors_that_disagree(void **state) {
    (void)state;
    assert_non_null(errors(1.0, 2.5, 100));
    assert_non_null(strstr(text, "2.5 times"));
    assert_non_null(strstr(text, "neighbouring"));
    assert_non_null(errors(0.3, 0.9, 100));
    assert_non_null(strstr(text, "rotated"));
    assert_null(errors(1.4, 0.7, 100));
    assert_null(errors(5.0, 5.0, 9));
    assert_null(errors(1.9, 1.0, 10)); /* exp(3 / sqrt(18)) = 2.03 */
    assert_non_null(errors(2.1, 1.0, 10));
    assert_null(errors(2.5, 2.5, 0));
}

static void all_of_a_sound_result(void **state) {
    (void)state;
    sheard_advice_list list;
    shear_result r = sound();
    sheard_advice_all(&list, &r, &plan, NULL);
    assert_int_equal(list.n, 0);
    r.top_share = 0.5;
    r.noise_effect = 0.05;
    r.noise_level = 1.05;
    sheard_advice_all(&list, &r, &plan, "x.fits");
    assert_int_equal(list.n, 2);
    assert_non_null(strstr(list.lines[0], "stamp 7 of x.fits"));
    assert_non_null(strstr(list.lines[1], "5.0 +- 0.1 % stronger"));
    r.valid = false;
    sheard_advice_all(&list, &r, &plan, NULL);
    assert_int_equal(list.n, 0);
}

/* Stronger noise under the galaxies makes the sides of their borders differ by more: no gradient.
 */
static void noise_is_no_gradient(void **state) {
    (void)state;
    shear_plan_info small = plan;
    shear_result r = sound();
    small.geometry.nx = 32;
    small.geometry.ny = 16;
    r.mean_flux = 10.0;
    r.border_noise_var = 1.0;
    r.border_step2 = 3.0 * 2.0 * (1.0 / 32 + 1.0 / 16);
    r.border_step2_err = 0.001;
    r.noise_level = 4.0;
    assert_null(sheard_advice_gradient(&r, &small, text, sizeof text));
    r.noise_level = 1.0;
    assert_non_null(strstr(sheard_advice_gradient(&r, &small, text, sizeof text), "gradients lie"));
    r.noise_level = NAN;
    assert_non_null(sheard_advice_gradient(&r, &small, text, sizeof text));
}

/* Of stamps that are the same the steps differ by rounding, and there is no flux beside it. */
static void rounding_is_no_gradient(void **state) {
    (void)state;
    shear_plan_info small = plan;
    small.geometry.nx = small.geometry.ny = 32;
    shear_result r = sound();
    r.noise_level = 1.0;
    r.mean_flux = 1e-14;
    r.border_noise_var = 1.0;
    r.border_step2_err = 1e-18;
    r.border_step2 = 1e-16;
    assert_null(sheard_advice_gradient(&r, &small, text, sizeof text));
    r.border_step2 = 1e-3;
    assert_non_null(sheard_advice_gradient(&r, &small, text, sizeof text));
}

/* Files of which no path is known are counted, each once, and only where they are doubtful. */
static void other_psfs_need_no_path(void **state) {
    (void)state;
    enum { FILES = 3 * SHEARD_ADVICES };
    shear_plan_info bad = plan;
    sheard_report_file files[FILES + 1] = {{.path = NULL}};
    char expected[64];
    bad.psf.unusable = 1;
    bad.psf.looked_at = 2;
    for (int i = 0; i < FILES; i++)
        files[i].plan = i % 3 == 2 ? &plan : &bad;
    snprintf(expected, sizeof expected, "%d of %d files", 2 * SHEARD_ADVICES, FILES + 1);
    const char *line = sheard_advice_other_psfs(files, FILES + 1, "first", text, sizeof text);
    assert_non_null(line);
    assert_non_null(strstr(line, expected));
    assert_non_null(strstr(line, "1 of 2 PSFs"));
}

/* A few stamps do not tell how much they scatter. */
static void few_stamps_tell_no_gradient_and_no_shape(void **state) {
    (void)state;
    shear_plan_info small = plan;
    small.geometry.nx = small.geometry.ny = 32;
    for (int n = 9; n <= 10; n++) {
        shear_result r = sound();
        r.n_used = n;
        r.n_eff = n;
        r.mean_flux = 10.0;
        r.border_step_x = 1.0;
        r.border_step_x_err = 0.01;
        r.noise_shape = -0.1;
        assert_int_equal(sheard_advice_gradient(&r, &small, text, sizeof text) != NULL, n == 10);
        assert_int_equal(sheard_advice_noise_shape(&r, &small, text, sizeof text) != NULL, n == 10);
    }
}

static void reasons_have_names(void **state) {
    static const char *const names[] = {
        NULL,      "too_few_stamps", "no_weight",   "same_stamps",  "no_signal",
        "swapped", "too_narrow",     "no_symmetry", "mixed_frames", "not_finite"};
    (void)state;
    for (enum shear_no_shear why = SHEAR_HAS_SHEAR; why <= SHEAR_NOT_FINITE; why++) {
        const char *name = sheard_no_shear_name(why);
        if (names[why] == NULL) {
            assert_null(name);
            assert_null(sheard_no_shear_words(why));
        } else {
            assert_string_equal(name, names[why]);
            assert_non_null(sheard_no_shear_words(why));
        }
        assert_int_equal(sheard_no_shear_of(name), why);
    }
    assert_int_equal(sheard_no_shear_of("other"), SHEAR_HAS_SHEAR);
    assert_null(sheard_no_shear_name(SHEAR_NOT_FINITE + 1));
    assert_null(sheard_no_shear_name((enum shear_no_shear) - 1));
}

static void reasons_in_words(void **state) {
    (void)state;
    shear_result r = sound();
    r.valid = false;
    r.signal = -41.0;
    r.sum_d = -3.0;
    r.why = SHEAR_SWAPPED;
    assert_non_null(strstr(sheard_no_shear_text(&r, text, sizeof text), "swapped? (the sum"));
    assert_non_null(strstr(text, "-41 sigma"));
    assert_non_null(strstr(sheard_no_shear_advice(&r, text, sizeof text), "exchange"));
    r.why = SHEAR_TOO_NARROW;
    assert_non_null(strstr(sheard_no_shear_text(&r, text, sizeof text), "narrower than the PSF"));
    assert_non_null(strstr(sheard_no_shear_advice(&r, text, sizeof text), "OVERSAMP"));
    /* One stamp has most of the squares: that is it, whatever it looks like. */
    r.n_eff = 1.1;
    r.top_share = 0.95;
    assert_non_null(strstr(sheard_no_shear_text(&r, text, sizeof text), "stamp 7 outweighs"));
    assert_non_null(strstr(sheard_no_shear_advice(&r, text, sizeof text), "--stamp 7"));
    assert_non_null(strstr(sheard_no_shear_brief(&r), "one stamp"));
    r.why = SHEAR_NO_WEIGHT;
    assert_string_equal(sheard_no_shear_text(&r, text, sizeof text), "all weights are 0");
    r.why = SHEAR_NO_STAMPS;
    r.n_used = 1;
    assert_non_null(strstr(sheard_no_shear_text(&r, text, sizeof text), "1 of 1000 stamps are"));
    assert_non_null(strstr(text, "no error"));
    r.why = SHEAR_NO_SYMMETRY;
    r.n_used = 15;
    assert_non_null(strstr(sheard_no_shear_text(&r, text, sizeof text), "15 usable stamps"));
}

static void many_artefacts(void **state) {
    (void)state;
    shear_result r = sound();
    int bit = 0;
    while (1u << bit != SHEAR_FLAG_ARTEFACT)
        bit++;
    r.flagged[bit] = 20; /* of 1000 */
    assert_null(sheard_advice_many_artefacts(&r, &plan, text, sizeof text));
    r.flagged[bit] = 26;
    assert_non_null(sheard_advice_many_artefacts(&r, &plan, text, sizeof text));
    assert_non_null(strstr(text, "2.6 % of the stamps"));
    r.n_stamps = 20;
    r.flagged[bit] = 3;
    assert_null(sheard_advice_many_artefacts(&r, &plan, text, sizeof text));
}

/* Of `bright` stamps `sharp` are sharper than their PSF, with triples in blocks. */
static const char *broad(int64_t bright, int64_t sharp, int64_t of_bright, int64_t of_sharp,
                         const shear_plan_info *info) {
    shear_result r = sound();
    r.n_bright = bright;
    r.n_sharp = sharp;
    r.bright_triples = of_bright;
    r.sharp_triples = of_sharp;
    return sheard_advice_broad_psf(&r, info, text, sizeof text);
}

static void stamps_sharper_than_their_psf(void **state) {
    (void)state;
    shear_plan_info info = plan;
    info.geometry = (shear_geometry){.nx = 64, .ny = 64};
    info.beta_px = 3.2;
    assert_null(broad(0, 0, 0, 0, &info));
    assert_null(broad(40, 4, 100, 1, &info)); /* too few to be sure */
    assert_null(broad(1000, 20, 2000, 1, &info));
    assert_non_null(broad(1000, 21, 2000, 1, &info));
    assert_non_null(strstr(text, "21 of 1000 bright stamps are sharper than their PSF, which"));
    /* one chip of 60: few in all, but in the same blocks */
    assert_null(broad(9000, 70, 20000, 9, &info));
    assert_non_null(broad(9000, 70, 20000, 10, &info));
    assert_non_null(strstr(text, "and come together"));
    assert_null(broad(9000, 179, 2000000, 300, &info)); /* 16 by chance */

    shear_result r = sound();
    sheard_cause cause;
    r.n_bright = 100;
    r.n_sharp = 5;
    assert_false(sheard_cause_of(&r, &info, &cause)); /* a warning only */
    r.n_sharp = 40;
    assert_true(sheard_cause_of(&r, &info, &cause));
    assert_non_null(strstr(cause.words, "the PSF is too broad"));
    r.valid = false;
    r.why = SHEAR_TOO_NARROW; /* has words of its own */
    assert_false(sheard_cause_of(&r, &info, &cause));
    r.why = SHEAR_NO_SIGNAL;
    assert_true(sheard_cause_of(&r, &info, &cause));

    shear_plan_info narrow = info;
    narrow.r_psf_px = 0.55;
    assert_null(broad(100, 40, 0, 0, &narrow)); /* aliases */
    narrow.interpolation = SHEAR_INTERP_LOG_BICUBIC;
    assert_non_null(broad(100, 40, 0, 0, &narrow));
    shear_plan_info small = info;
    small.geometry = (shear_geometry){.nx = 22, .ny = 22};
    assert_null(broad(100, 40, 0, 0, &small)); /* periodic */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_noise_level_that_matters),
        cmocka_unit_test(a_noise_level_that_cannot_be_checked),
        cmocka_unit_test(another_spectrum),
        cmocka_unit_test(noise_stamps_without_noise),
        cmocka_unit_test(one_stamp_decides),
        cmocka_unit_test(a_long_name_is_cut),
        cmocka_unit_test(one_stamp_decides_the_level),
        cmocka_unit_test(errors_that_disagree),
        cmocka_unit_test(all_of_a_sound_result),
        cmocka_unit_test(noise_is_no_gradient),
        cmocka_unit_test(rounding_is_no_gradient),
        cmocka_unit_test(other_psfs_need_no_path),
        cmocka_unit_test(few_stamps_tell_no_gradient_and_no_shape),
        cmocka_unit_test(many_artefacts),
        cmocka_unit_test(reasons_have_names),
        cmocka_unit_test(reasons_in_words),
        cmocka_unit_test(stamps_sharper_than_their_psf),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

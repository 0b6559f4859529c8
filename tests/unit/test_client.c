/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl's pure parts: the advice's thresholds, and the options made from the table of settings.
 */
#include "test.h"

#include "cmdline/settings_options.h"
#include "sheard/advice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static char text[SHEARD_ADVICE_SIZE];

static const char *filter_advice(double removed, double error, enum shear_filter filter) {
    shear_result r = {.filter_removed = removed, .filter_removed_err = error};
    shear_plan_info plan = {.filter = filter, .core_px = 20.0};
    return sheard_advice_filter(&r, &plan, text, sizeof text);
}

static void filter_warns_above_one_percent_and_three_errors(void **state) {
    (void)state;
    assert_non_null(filter_advice(0.011, 0.003, SHEAR_FILTER_EDGE));
    assert_non_null(strstr(text, "1.1 %"));
    assert_non_null(strstr(text, "--core larger than 20 px"));
    assert_null(filter_advice(0.009, 0.0, SHEAR_FILTER_EDGE));
    assert_null(filter_advice(0.011, 0.004, SHEAR_FILTER_EDGE));
    assert_null(filter_advice(0.5, 0.0, SHEAR_FILTER_NONE));
    assert_null(filter_advice(NAN, NAN, SHEAR_FILTER_EDGE));
    const shear_result r = {.filter_removed = 0.03, .filter_removed_err = 0.001};
    shear_plan_info plan = {.filter = SHEAR_FILTER_PAPER, .core_px = 20.0};
    assert_non_null(sheard_advice_filter(&r, &plan, text, sizeof text));
    plan.core_found = true; /* it is known what that core does to the shear */
    assert_null(sheard_advice_filter(&r, &plan, text, sizeof text));
}

/* 10 x 10 px and a mean flux of 100: 2 % of the flux is 0.02 a pixel. */
static shear_plan_info small_plan(enum shear_filter filter) {
    return (shear_plan_info){.geometry = {.nx = 10, .ny = 10}, .filter = filter};
}

static const char *bright_advice(double excess, double error, enum shear_filter filter) {
    shear_result r = {.border_excess = excess, .border_excess_err = error, .mean_flux = 100.0};
    shear_plan_info plan = small_plan(filter);
    return sheard_advice_bright_border(&r, &plan, text, sizeof text);
}

static void bright_border_warns(void **state) {
    (void)state;
    assert_non_null(bright_advice(0.021, 0.005, SHEAR_FILTER_NONE));
    assert_non_null(strstr(text, "2.1 % of the mean flux"));
    assert_non_null(strstr(text, "larger stamps"));
    assert_null(strstr(text, "edge"));
    assert_null(bright_advice(0.019, 0.0, SHEAR_FILTER_NONE));
    assert_null(bright_advice(0.021, 0.006, SHEAR_FILTER_NONE));
    assert_null(bright_advice(-1.0, 0.0, SHEAR_FILTER_NONE));
    assert_null(bright_advice(1.0, 0.0, SHEAR_FILTER_EDGE));
}

static const char *rough_advice(double rough, double error, double noise,
                                enum shear_filter filter) {
    shear_result r = {.border_rough = rough,
                      .border_rough_err = error,
                      .border_noise_var = noise,
                      .mean_flux = 100.0};
    shear_plan_info plan = small_plan(filter);
    return sheard_advice_rough_border(&r, &plan, text, sizeof text);
}

static void rough_border_warns(void **state) {
    (void)state;
    /* rms 0.021 a pixel: variance 4.41e-4 */
    assert_non_null(rough_advice(4.41e-4, 1e-4, 0.0, SHEAR_FILTER_NONE));
    assert_non_null(strstr(text, "rougher"));
    assert_null(strstr(text, "edge"));
    assert_null(rough_advice(3.61e-4, 1e-6, 0.0, SHEAR_FILTER_NONE));
    assert_null(rough_advice(4.41e-4, 1.2e-4, 0.0, SHEAR_FILTER_NONE));
    assert_non_null(rough_advice(0.06, 0.01, 1.0, SHEAR_FILTER_NONE));
    assert_null(rough_advice(0.04, 0.001, 1.0, SHEAR_FILTER_NONE));
    assert_null(rough_advice(-0.5, 0.0, 1.0, SHEAR_FILTER_NONE));
    assert_null(rough_advice(0.06, 0.01, 1.0, SHEAR_FILTER_EDGE));
}

/* Steps of noise that is stronger under the galaxies are none: of 10 x 10 px a side has 8 pixels,
 * and the square of both steps is 2 (1/8 + 1/8) of the variance. */
static void steps_of_stronger_noise_are_no_gradients(void **state) {
    (void)state;
    const shear_plan_info plan = small_plan(SHEAR_FILTER_NONE);
    shear_result r = {.n_used = 100,
                      .n_eff = 100.0,
                      .border_step2 = 1.5 * 0.5,
                      .border_step2_err = 0.01,
                      .border_noise_var = 1.0,
                      .noise_level = 2.5,
                      .mean_flux = 100.0};
    assert_null(sheard_advice_gradient(&r, &plan, text, sizeof text));
    r.border_step2 += 0.25;
    assert_non_null(sheard_advice_gradient(&r, &plan, text, sizeof text));
    assert_non_null(strstr(text, "differ by 0.5 per pixel"));
    r.border_step2 = 0.75;
    r.noise_level = NAN;
    assert_non_null(sheard_advice_gradient(&r, &plan, text, sizeof text));
    r.valid = true; /* another spectrum makes other steps */
    r.noise_shape = -0.5;
    r.noise_shape_err = 0.01;
    r.noise_share = 1.0;
    assert_null(sheard_advice_gradient(&r, &plan, text, sizeof text));
}

/* Nothing where nothing is known; a line a flaw, with counts where there are several PSFs, and room
 * for all at once. */
static void psf_warns(void **state) {
    (void)state;
    sheard_advice_list list = {.n = 0};
    shear_plan_info plan = {.beta_px = 3.0};
    sheard_advice_psf(&list, &plan);
    assert_int_equal(list.n, 0);
    plan.psf = (shear_psf_summary){
        .looked_at = 1,
        .flawed = {[SHEAR_PSF_CUT] = 1},
        .worst = {
            .r_psf_px = 1.5, .border = 1e-3, .rim_px = 7.0, .border_slope = 4.0, .cut = 0.02}};
    sheard_advice_psf(&list, &plan);
    assert_int_equal(list.n, 1);
    assert_string_equal(
        list.lines[0],
        "the PSF's wings are cut off where they are at 0.1 % of the peak (about 2 % of the light "
        "is "
        "missing), which biases the shear by about 0.4 %: give a larger image of the PSF, with no "
        "background left in");
    plan.psf.looked_at = 256;
    plan.psf.unusable = 3;
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++)
        plan.psf.flawed[i] = 200 + i;
    shear_result r = {.n_used = 2};
    sheard_advice_all(&list, &r, &plan, NULL);
    assert_true(list.n >= 6);
    assert_non_null(strstr(list.lines[list.n - 6], "3 of 256 PSFs examined are unusable"));
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++) {
        char count[40];
        const char *line = list.lines[list.n - 5 + (size_t)i];
        snprintf(count, sizeof count, "%d of 256 PSFs examined (the worst): ", 200 + i);
        assert_true(strncmp(line, count, strlen(count)) == 0);
        assert_true(strlen(line) < SHEARD_ADVICE_SIZE - 1);
    }
}

/* Some value of a setting that is not its default. */
static const char *other_value(const shear_setting_def *def, char *buf, size_t size) {
    if (def->type == SHEAR_T_CHOICE) {
        snprintf(buf, size, "%s", def->choices[1]);
    } else {
        snprintf(buf, size, "%g",
                 def->type == SHEAR_T_INT ? 4.0 : fmin(def->max, fmax(def->min, 0.5)));
    }
    return buf;
}

static void every_setting_is_an_option(void **state) {
    (void)state;
    option_entry options[SETTINGS_OPTIONS_MAX] = {0};
    option_settings s = {.given = {false}};
    size_t n = settings_options_add(options, &s);
    size_t n_settings = 0;
    const shear_setting_def *table = shear_settings_table(&n_settings);
    size_t at = 0;
    for (size_t i = 0; i < n_settings; i++) {
        char value[64];
        char got[64];
        bool is_bool = table[i].type == SHEAR_T_BOOL;
        shear_settings_init(&s.values);
        memset(s.given, 0, sizeof s.given);
        assert_string_equal(options[at].name, table[i].name);
        assert_int_equal(options[at].bare, is_bool);
        if (is_bool) {
            char no[64];
            snprintf(no, sizeof no, "no-%s", table[i].name);
            assert_string_equal(options[at + 1].name, no);
            assert_int_equal(options[at + 1].set(&options[at + 1], NULL), EXIT_CODE_DONE);
            assert_string_equal(shear_settings_format(&s.values, &table[i], got, sizeof got),
                                "false");
            assert_int_equal(options[at].set(&options[at], NULL), EXIT_CODE_DONE);
            assert_string_equal(shear_settings_format(&s.values, &table[i], got, sizeof got),
                                "true");
        } else {
            other_value(&table[i], value, sizeof value);
            assert_int_equal(options[at].set(&options[at], value), EXIT_CODE_DONE);
            assert_string_equal(shear_settings_format(&s.values, &table[i], got, sizeof got),
                                value);
        }
        assert_true(s.given[i]);
        at += is_bool ? 2 : 1;
    }
    assert_int_equal(at, n);
    assert_true(n < SETTINGS_OPTIONS_MAX);
    assert_null(options[n].name);
}

/* Every line of the help fits a terminal, and has name, default and help of every setting. */
static void help_has_everything(void **state) {
    (void)state;
    char *help = NULL;
    size_t size = 0;
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    FILE *out = open_memstream(&help, &size);
    assert_non_null(out);
    settings_options_help(out);
    fclose(out);
    for (size_t i = 0; i < n; i++) {
        char flag[64];
        snprintf(flag, sizeof flag, "  --%s", table[i].name);
        assert_non_null(strstr(help, flag));
    }
    for (const char *line = help; *line; line += strcspn(line, "\n") + 1)
        assert_true(strcspn(line, "\n") < 80);
    free(help);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filter_warns_above_one_percent_and_three_errors),
        cmocka_unit_test(bright_border_warns),
        cmocka_unit_test(steps_of_stronger_noise_are_no_gradients),
        cmocka_unit_test(rough_border_warns),
        cmocka_unit_test(psf_warns),
        cmocka_unit_test(every_setting_is_an_option),
        cmocka_unit_test(help_has_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON reports: numbers that read back to the same bits, null for what is not finite, text of any
 * bytes, and no leak when the n-th allocation fails. */
#include "test.h"

#include "sheard/account.h"
#include "sheard/report.h"
#include "sheard/validation_report.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static shear_plan_info a_plan(void) {
    return (shear_plan_info){.interpolation = SHEAR_INTERP_LOG_SPLINE,
                             .oversample = 8,
                             .r_psf_px = 0.67,
                             .beta_px = 1.005,
                             .filter = SHEAR_FILTER_NONE,
                             .core_px = NAN,
                             .width_px = NAN,
                             .k_cut = 1.0 / 3.0};
}

static shear_result a_result(void) {
    shear_result r = {
        .valid = true, .g1 = 0.1, .g2 = -1.0 / 3.0, .g1_err = 5e-324, .g2_err = INFINITY};
    r.cov12 = nextafter(1e-9, 1.0);
    r.n_stamps = 9007199254740993; /* 2^53 + 1: no double */
    r.n_used = 7;
    r.flagged[2] = 3;
    return r;
}

/* The report above in full, with a path and a field of odd bytes; malloc'd. */
static int make(char **text, shear_error *err) {
    static const char *const warnings[] = {"one \"quoted\"", "two"};
    shear_plan_info plan = a_plan();
    shear_result result = a_result();
    shear_settings settings;
    shear_settings_init(&settings);
    settings.beta_px = 2.5;
    sheard_report_file files[2] = {
        {"a\xFF.fits", "00ff", "f", 5, 4, &plan, 0.5},
        {"\xC3\xA4\xED\xA0\x80\xF4\x90\x80\x80\xE2\x82", "00fe", "f", 5, 3, &plan, 0.25}};
    sheard_report report = {.field = "tab\tand\x01",
                            .result = &result,
                            .settings = &settings,
                            .plan = &plan,
                            .files = files,
                            .n_files = 2,
                            .has_truth = true,
                            .true_g1 = 0.1,
                            .true_g2 = 0.0,
                            .warnings = warnings,
                            .n_warnings = 2,
                            .seconds = 0.75};
    return sheard_report_json(text, &report, err);
}

/* The number after "key": in the text. */
static double number_at(const char *text, const char *key) {
    char quoted[40];
    snprintf(quoted, sizeof quoted, "\"%s\":", key);
    const char *at = strstr(text, quoted);
    assert_non_null(at);
    return strtod(at + strlen(quoted), NULL);
}

static void numbers_keep_their_bits(void **state) {
    (void)state;
    char *text = NULL;
    shear_error err = {0};
    assert_int_equal(make(&text, &err), SHEAR_OK);
    shear_result r = a_result();
    assert_true(number_at(text, "g1") == r.g1);
    assert_true(number_at(text, "g2") == r.g2);
    assert_true(number_at(text, "g1_err") == r.g1_err);
    assert_true(number_at(text, "cov12") == r.cov12);
    assert_true(number_at(text, "k_cut") == 1.0 / 3.0);
    assert_non_null(strstr(text, "\"n_stamps\":9007199254740993,"));
    free(text);
}

static void what_is_not_finite_is_null(void **state) {
    (void)state;
    char *text = NULL;
    assert_int_equal(make(&text, NULL), SHEAR_OK);
    assert_non_null(strstr(text, "\"g2_err\":null,"));
    assert_non_null(strstr(text, "\"core_px\":null,"));
    /* the pull of g2 is finite over infinite, 0; that of g1 is 0 over a tiny number */
    assert_non_null(strstr(text, "\"pull\":{\"g1\":0.0,\"g2\":-0.0}"));
    assert_null(strstr(text, "nan"));
    assert_null(strstr(text, ":inf"));
    assert_null(strstr(text, ":-inf"));
    free(text);
}

static void text_is_made_utf8(void **state) {
    (void)state;
    char *text = NULL;
    assert_int_equal(make(&text, NULL), SHEAR_OK);
    assert_non_null(strstr(text, "\"path\":\"a\\uFFFD.fits\""));
    /* A good letter; a surrogate of three bytes, a code beyond U+10FFFF of four, and a cut one of
     * two: a U+FFFD a byte. */
    assert_non_null(strstr(text, "\"path\":\"\\u00E4"
                                 "\\uFFFD\\uFFFD\\uFFFD"
                                 "\\uFFFD\\uFFFD\\uFFFD\\uFFFD"
                                 "\\uFFFD\\uFFFD\""));
    assert_non_null(strstr(text, "\"field\":\"tab\\tand\\u0001\""));
    assert_non_null(strstr(text, "[\"one \\\"quoted\\\"\",\"two\"]"));
    assert_null(strchr(text, '\n'));
    free(text);
}

static void settings_have_native_types(void **state) {
    (void)state;
    char *text = NULL;
    assert_int_equal(make(&text, NULL), SHEAR_OK);
    assert_non_null(strstr(text, "\"settings\":{\"preset\":\"default\",\"interpolation\":\"auto\","
                                 "\"oversample\":\"auto\",\"beta\":2.5,"));
    assert_non_null(strstr(text, "\"noise-correction\":true"));
    assert_non_null(
        strstr(text, "\"resolved\":{\"interpolation\":\"log-spline\",\"oversample\":8,"));
    free(text);
}

static void an_unopened_file_has_nulls(void **state) {
    (void)state;
    char *text = NULL;
    shear_settings settings;
    shear_settings_init(&settings);
    sheard_validation_report v = {
        .path = "x", .conclusion = "no such file", .advice = "", .settings = &settings};
    assert_int_equal(sheard_validation_report_json(&text, &v, NULL), SHEAR_OK);
    assert_non_null(
        strstr(text, "{\"path\":\"x\",\"good\":false,\"verdict\":\"no such file\",\"advice\":\"\","
                     "\"field\":null,"));
    assert_non_null(strstr(text, "\"resolved\":null,\"psf\":null,\"warnings\":[],\"n_measurable\":"
                                 "null,\"flags\":null,\"negative\":null,"));
    free(text);
}

/* ---- memory that ends ---- */
static long live, calls, fail_at;

static void *counted_malloc(size_t size) {
    if (++calls == fail_at)
        return NULL;
    void *memory = malloc(size);
    live += memory != NULL;
    return memory;
}

static void counted_free(void *memory) {
    live -= memory != NULL;
    free(memory);
}

static int make_validation_report(char **text, shear_error *err) {
    shear_plan_info plan = a_plan();
    shear_field_info field = {.name = "f", .pixscale = 0.2, .has_truth = true};
    shear_settings settings;
    shear_settings_init(&settings);
    sheard_validation_report v = {.path = "x",
                                  .conclusion = "",
                                  .advice = "",
                                  .field = &field,
                                  .plan = &plan,
                                  .settings = &settings};
    v.scanned = true;
    v.flags[1] = (sheard_fault){.count = 99, .first = {1, 2, 3, 4, 5, 6, 7, 8}};
    return sheard_validation_report_json(text, &v, err);
}

static void fails_cleanly(int (*maker)(char **, shear_error *)) {
    int code = SHEAR_E_NOMEM;
    json_set_alloc_funcs(counted_malloc, counted_free);
    for (fail_at = 1; code != SHEAR_OK; fail_at++) {
        char *text = (char *)"untouched";
        shear_error err = {0};
        live = calls = 0;
        code = maker(&text, &err);
        assert_int_equal(live, 0);
        if (code == SHEAR_OK) {
            assert_true(calls < fail_at); /* it never came to that allocation */
            free(text);
        } else {
            assert_int_equal(code, SHEAR_E_NOMEM);
            assert_null(text);
            assert_string_equal(err.message, "out of memory while writing JSON");
        }
    }
    assert_true(fail_at > 100);
    json_set_alloc_funcs(malloc, free);
}

static void no_memory_for_a_report(void **state) {
    (void)state;
    fails_cleanly(make);
}

static void no_memory_for_a_validation_report(void **state) {
    (void)state;
    fails_cleanly(make_validation_report);
}

/* A file's entry in a report is the same when it was made from its account. */
static void accounts_keep_all(void **state) {
    (void)state;
    shear_error err = {0};
    char *texts[2] = {NULL, NULL};
    sheard_account account;
    shear_plan_info plan = a_plan();
    plan.filter = SHEAR_FILTER_PAPER;
    plan.filter_per_stamp = true;
    plan.core_found = true;
    plan.noise_band = SHEAR_NOISE_BAND_CORNERS;
    plan.geometry.nx = 48;
    plan.geometry.ny = 50;
    plan.psf = (shear_psf_summary){
        .looked_at = 64,
        .unusable = 2,
        .flawed = {1, 2, 3, 4, 5},
        .worst = {1.0 / 7.0, 1e-3, 12.5, 1e-5, INFINITY, NAN, 1.0 / 3.0, 1.4, -0.01}};
    const sheard_report_file file = {"a\xFF \"b\".fits", "00ff", "f", 5, 4, &plan, 1.0 / 3.0};
    assert_int_equal(sheard_account_format(&texts[0], &file, &err), SHEAR_OK);
    assert_int_equal(sheard_account_parse(&account, texts[0], &err), SHEAR_OK);
    assert_int_equal(sheard_account_format(&texts[1], &account.file, &err), SHEAR_OK);
    assert_string_equal(texts[0], texts[1]);
    assert_int_equal(account.plan.geometry.nx, 48);
    assert_int_equal(account.plan.geometry.ny, 50);
    assert_true(account.plan.filter_per_stamp);
    assert_true(account.plan.core_found);
    assert_int_equal(account.plan.noise_band, SHEAR_NOISE_BAND_CORNERS);
    assert_int_equal(account.plan.filter, SHEAR_FILTER_PAPER);
    assert_int_equal(account.plan.interpolation, SHEAR_INTERP_LOG_SPLINE);
    assert_true(isnan(account.plan.core_px));
    assert_true(account.plan.k_cut == plan.k_cut);
    assert_int_equal(account.plan.psf.looked_at, 64);
    assert_memory_equal(account.plan.psf.flawed, plan.psf.flawed, sizeof plan.psf.flawed);
    assert_true(account.plan.psf.worst.noise == 1.0 / 3.0 &&
                account.plan.psf.worst.r_psf_px == 1.0 / 7.0);
    sheard_account_deinit(&account);
    free(texts[0]);
    free(texts[1]);
    static const char *const bad[] = {"", "[]", "{", "1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(sheard_account_parse(&account, bad[i], &err), SHEAR_E_FORMAT);
        assert_null(account.texts);
    }
    assert_int_equal(sheard_account_parse(&account, "{\"path\":\"x\",\"resolved\":null}", &err),
                     SHEAR_OK);
    assert_null(account.file.plan);
    assert_null(account.file.checksum);
    sheard_account_deinit(&account);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accounts_keep_all),
        cmocka_unit_test(numbers_keep_their_bits),
        cmocka_unit_test(what_is_not_finite_is_null),
        cmocka_unit_test(text_is_made_utf8),
        cmocka_unit_test(settings_have_native_types),
        cmocka_unit_test(an_unopened_file_has_nulls),
        cmocka_unit_test(no_memory_for_a_report),
        cmocka_unit_test(no_memory_for_a_validation_report),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

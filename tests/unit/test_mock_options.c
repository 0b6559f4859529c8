/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The option table, and specs that are refused. */
#include "test_mock_fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Every option has the same value in both. */
static void check_equal(const shear_mock_spec *a, const shear_mock_spec *b) {
    size_t n;
    const shear_mock_option *table = shear_mock_options(&n);
    for (size_t i = 0; i < n; i++) {
        char first[96], second[96];
        shear_mock_format(a, &table[i], first, sizeof first);
        shear_mock_format(b, &table[i], second, sizeof second);
        assert_string_equal(first, second);
    }
}

static void test_defaults_are_good(void **state) {
    (void)state;
    shear_mock_spec s;
    shear_error err = {0};
    shear_mock_spec_init(&s);
    assert_int_equal(shear_mock_spec_check(&s, &err), SHEAR_OK);
}

static void test_every_value_reads_back(void **state) {
    (void)state;
    static const char *const values[][2] = {{"stamps", "123456789"},
                                            {"size", "32x24"},
                                            {"seed", "18446744073709551615"},
                                            {"shear", "-0.1,0.3333333333333333"},
                                            {"rotate", "4"},
                                            {"no-shift", "yes"},
                                            {"offset", "-1.5,0.25"},
                                            {"share-shift", "yes"},
                                            {"share-noise", "yes"},
                                            {"turn-stamps", "yes"},
                                            {"galaxy", "irregular"},
                                            {"r-gal", "5.1"},
                                            {"points", "77"},
                                            {"bulge-fraction", "0.1"},
                                            {"disk-scale", "0.7"},
                                            {"bulge-ratio", "4"},
                                            {"inclination", "10,20.5"},
                                            {"steps", "900"},
                                            {"step-size", "0.3"},
                                            {"psf", "b"},
                                            {"r-psf", "0.67"},
                                            {"psf-angle", "-12.5"},
                                            {"oversamp", "16"},
                                            {"psf-size", "101"},
                                            {"psf-per-stamp", "yes"},
                                            {"psf-ids", "5"},
                                            {"noise-stamps", "3"},
                                            {"noise-ratio", "0.6"},
                                            {"noise-density", "4"},
                                            {"white", "0.5"},
                                            {"photons", "1000"},
                                            {"photon-snr", "0.01"},
                                            {"subtract-background", "yes"},
                                            {"field", "Some field, 2"},
                                            {"layout", "mosaic"},
                                            {"bitpix", "-64"},
                                            {"no-r-gal", "yes"}};
    size_t n;
    shear_mock_options(&n);
    assert_int_equal(n, sizeof values / sizeof *values); /* none is forgotten here */
    shear_mock_spec s, again;
    shear_error err = {0};
    shear_mock_spec_init(&s);
    shear_mock_spec_init(&again);
    for (size_t i = 0; i < n; i++) {
        char before[96], after[96];
        const shear_mock_option *o = shear_mock_option_find(values[i][0]);
        assert_non_null(o);
        shear_mock_format(&s, o, before, sizeof before);
        assert_int_equal(shear_mock_set(&s, values[i][0], values[i][1], &err), SHEAR_OK);
        shear_mock_format(&s, o, after, sizeof after);
        assert_string_equal(after, values[i][1]);
        assert_string_not_equal(before, after); /* each value here is not the default */
        assert_int_equal(shear_mock_set(&again, values[i][0], after, &err), SHEAR_OK);
    }
    check_equal(&s, &again);
    assert_true(s.g1 == -0.1 && s.g2 == 1.0 / 3.0 && s.nx == 32 && s.ny == 24);
    assert_true(!s.shift && !s.write_r_gal && s.share_noise && s.galaxy == SHEAR_MOCK_IRREGULAR);
}

static void test_short_forms(void **state) {
    (void)state;
    shear_mock_spec s;
    char text[96];
    shear_mock_spec_init(&s);
    assert_int_equal(shear_mock_set(&s, "size", "100", NULL), SHEAR_OK);
    assert_true(s.nx == 100 && s.ny == 100);
    assert_int_equal(shear_mock_set(&s, "no-shift", NULL, NULL), SHEAR_OK);
    assert_false(s.shift);
    assert_int_equal(shear_mock_set(&s, "no-shift", "no", NULL), SHEAR_OK);
    assert_true(s.shift);
    s.noise_density = 3.0;
    s.psf_size = 9;
    assert_int_equal(shear_mock_set(&s, "noise-density", "auto", NULL), SHEAR_OK);
    assert_int_equal(shear_mock_set(&s, "psf-size", "auto", NULL), SHEAR_OK);
    assert_true(isnan(s.noise_density) && s.psf_size == 0);
    shear_mock_format(&s, shear_mock_option_find("noise-density"), text, sizeof text);
    assert_string_equal(text, "auto");
    shear_mock_format(&s, shear_mock_option_find("psf-size"), text, sizeof text);
    assert_string_equal(text, "auto");
}

/* A value that cannot be read, or is out of range: an error that names the option and the value;
 * nothing changes. */
static void test_bad_values(void **state) {
    (void)state;
    static const char *const bad[][2] = {
        {"stamps", "0"},
        {"stamps", "1.5"},
        {"stamps", ""},
        {"stamps", "99999999999999999999"},
        {"size", "7"},
        {"size", "64x"},
        {"size", "64x2000"},
        {"size", "64,64"},
        {"size", "x64"},
        {"size", "99999999999999999999x64"},
        {"seed", "-1"},
        {"seed", " 1"},
        {"seed", "18446744073709551616"},
        {"shear", "0.1"},
        {"shear", "0.1,nan"},
        {"shear", "1.5,0"},
        {"shear", "0.1;0.2"},
        {"shear", "0.1,0.2,0.3"},
        {"rotate", "5"},
        {"rotate", "2147483648"},
        {"no-shift", "true"},
        {"galaxy", "spiral"},
        {"galaxy", "2"},
        {"r-gal", "0"},
        {"r-gal", "inf"},
        {"r-gal", "3px"},
        {"points", "0"},
        {"points", "auto"},
        {"bulge-fraction", "-1"},
        {"disk-scale", "0"},
        {"inclination", "-1,30"},
        {"inclination", "0,91"},
        {"psf", "A"},
        {"r-psf", "0.01"},
        {"oversamp", "0"},
        {"psf-size", "2"},
        {"psf-size", "5000"},
        {"psf-ids", "-1"},
        {"noise-ratio", "-0.1"},
        {"noise-density", "0"},
        {"white", "-1"},
        {"photons", "1e9"},
        {"photon-snr", "0"},
        {"layout", "plane"},
        {"bitpix", "-16"},
        {"field", "tab\there"},
        {"field", "a name of more than sixty-eight characters does not fit into a FITS card"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        shear_mock_spec s, before;
        shear_error err = {0};
        shear_mock_spec_init(&s);
        before = s;
        int code = shear_mock_set(&s, bad[i][0], bad[i][1], &err);
        if (code != SHEAR_E_SETTING || strstr(err.message, bad[i][0]) == NULL)
            fail_msg("--%s %s: code %d, \"%s\"", bad[i][0], bad[i][1], code, err.message);
        check_equal(&s, &before);
    }
}

static void test_unknown_option(void **state) {
    (void)state;
    shear_mock_spec s;
    shear_error err = {0};
    shear_mock_spec_init(&s);
    assert_null(shear_mock_option_find("stamp"));
    assert_int_equal(shear_mock_set(&s, "stamp", "3", &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "stamp"));
    assert_true(err.advice[0] != '\0');
}

/* Settings (pairs, as many as needed) that contradict each other, and the option that the error
 * names. */
static const char *const contradictions[][8] = {
    {"shear", "shear", "0.8,0.8"},
    {"rotate", "rotate", "3"},
    {"size", "size", "16", "r-gal", "8"},
    {"size", "size", "64x20", "r-gal", "9.8"},
    {"size", "size", "24", "offset", "8,0"},
    {"inclination", "inclination", "30,20"},
    {"step-size", "galaxy", "irregular", "step-size", "7"},
    {"psf-ids", "psf-ids", "3", "psf-per-stamp", "yes"},
    {"psf-size", "r-psf", "50", "oversamp", "16"},
    {"noise-density", "noise-ratio", "1", "noise-density", "1e4", "size", "1024"},
    {"photons", "photons", "1e8", "photon-snr", "100"},
    {"subtract-background", "subtract-background", "yes"},
    {"bitpix", "bitpix", "-33"},
};

static void test_contradictions(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof contradictions / sizeof *contradictions; i++) {
        const char *const *c = contradictions[i];
        shear_mock_spec s;
        shear_mock *m = (shear_mock *)&s;
        shear_error err = {0};
        char named[64];
        shear_mock_spec_init(&s);
        for (int k = 1; k < 7 && c[k] != NULL; k += 2)
            assert_int_equal(shear_mock_set(&s, c[k], c[k + 1], NULL), SHEAR_OK);
        snprintf(named, sizeof named, "'%s'", c[0]);
        assert_int_equal(shear_mock_new(&m, &s, &err), SHEAR_E_SETTING);
        assert_null(m);
        if (strstr(err.message, named) == NULL)
            fail_msg("no word of %s: \"%s\"", named, err.message);
    }
}

/* A spec filled by a program, not by shear_mock_set. */
static void test_check_of_raw_specs(void **state) {
    (void)state;
    shear_mock_spec s;
    shear_error err = {0};
    shear_mock_spec_init(&s);
    s.galaxy = 2;
    assert_int_equal(shear_mock_spec_check(&s, &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "'galaxy'"));
    shear_mock_spec_init(&s);
    s.r_psf_px = NAN;
    assert_int_equal(shear_mock_spec_check(&s, &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "'r-psf'"));
    shear_mock_spec_init(&s);
    s.n_stamps = -4;
    assert_int_equal(shear_mock_spec_check(&s, NULL), SHEAR_E_SETTING);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults_are_good),  cmocka_unit_test(test_every_value_reads_back),
        cmocka_unit_test(test_short_forms),        cmocka_unit_test(test_bad_values),
        cmocka_unit_test(test_unknown_option),     cmocka_unit_test(test_contradictions),
        cmocka_unit_test(test_check_of_raw_specs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

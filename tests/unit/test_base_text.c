/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts in buffers of a fixed size, and numbers in texts. */
#include "base/text.h"
#include "test.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void what_does_not_fit_is_cut_off(void **state) {
    (void)state;
    char buf[8];
    assert_true(text_set(buf, sizeof buf, "seven 7"));
    assert_string_equal(buf, "seven 7");
    assert_false(text_set(buf, sizeof buf, "eight 88"));
    assert_string_equal(buf, "eight 8");
    assert_true(text_set(buf, sizeof buf, NULL));
    assert_string_equal(buf, "");
    assert_true(text_append(buf, sizeof buf, "%d-", 12));
    assert_true(text_append(buf, sizeof buf, "%s", "3456"));
    assert_string_equal(buf, "12-3456");
    assert_false(text_append(buf, sizeof buf, "x"));
    assert_string_equal(buf, "12-3456");
}

static void lists_have_commas(void **state) {
    (void)state;
    static const char *const words[] = {"a", "bc", "d", NULL};
    char buf[20];
    assert_true(text_list(buf, sizeof buf, words));
    assert_string_equal(buf, "a, bc, d");
    assert_true(text_list(buf, sizeof buf, words + 3));
    assert_string_equal(buf, "");
    assert_false(text_list(buf, 6, words));
    assert_string_equal(buf, "a, bc");
}

static void endings_have_no_case(void **state) {
    (void)state;
    assert_true(text_ends_with("a.FITS", ".fits"));
    assert_true(text_ends_with(".fits", ".fits"));
    assert_true(text_ends_with("x", ""));
    assert_false(text_ends_with("fits", ".fits"));
}

static void numbers_are_the_whole_text(void **state) {
    (void)state;
    int64_t n = 5;
    double x = 5.0;
    assert_true(text_to_int64("-9223372036854775808", &n));
    assert_true(n == INT64_MIN);
    assert_true(text_to_int64("42", &n));
    assert_int_equal(n, 42);
    static const char *const bad[] = {"", " ", "4x", "x", "4 ", "9223372036854775808", "1e3"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(text_to_int64(bad[i], &n));
    assert_int_equal(n, 42);
    assert_true(text_to_double("1e-3", &x));
    assert_true(x == 1e-3);
    assert_true(text_to_double("inf", &x) && isinf(x));
    assert_false(text_to_double("1.5px", &x));
    assert_false(text_to_double("", &x));
    assert_true(isinf(x));
}

static void words_are_true_or_false(void **state) {
    (void)state;
    static const char *const words[] = {"true", "yes", "on", "1", "false", "no", "off", "0"};
    for (size_t i = 0; i < 8; i++) {
        bool value = i >= 4;
        assert_true(text_to_bool(words[i], &value));
        assert_int_equal(value, i < 4);
    }
    bool value = true;
    assert_false(text_to_bool("", &value) || text_to_bool("True", &value));
    assert_true(value);
}

static void digits_suffice(void **state) {
    (void)state;
    static const double values[] = {0.0,     0.1,          1.0 / 3.0, -2.5e-300,
                                    DBL_MAX, DBL_TRUE_MIN, 123456.0};
    assert_int_equal(text_digits(0.5, 1), 1);
    assert_int_equal(text_digits(0.5, 15), 15);
    assert_int_equal(text_digits(1.0 / 3.0, 1), 16);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char text[40];
        snprintf(text, sizeof text, "%.*g", text_digits(values[i], 1), values[i]);
        assert_true(strtod(text, NULL) == values[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_does_not_fit_is_cut_off),
        cmocka_unit_test(lists_have_commas),
        cmocka_unit_test(endings_have_no_case),
        cmocka_unit_test(numbers_are_the_whole_text),
        cmocka_unit_test(words_are_true_or_false),
        cmocka_unit_test(digits_suffice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

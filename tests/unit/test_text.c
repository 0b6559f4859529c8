/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How names from outside are shown. */
#include "shear/text.h"
#include "test.h"

#include <string.h>

static void expect(const char *text, const char *wanted) {
    char buf[200];
    assert_string_equal(shear_text_clean(text, buf, sizeof buf), wanted);
}

static void test_shown(void **state) {
    (void)state;
    static const char *const good[] = {
        "",        "plain name.fits", "\u00dcbung", "\u661f\u7cfb", "\U0001f30c ~", "\u0627\u0644",
        "e\u0301", "\u00a0"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        expect(good[i], good[i]);
}

static void test_hidden(void **state) {
    (void)state;
    static const char *const bad[] = {
        "\x01",   "\n",     "\t",     "\x1b",   "\x7f",   "\xc2\x80", "\xc2\x9b", "\xc2\x9f",
        "\u00ad", "\u061c", "\u180e", "\u200b", "\u200c", "\u200d",   "\u200e",   "\u200f",
        "\u2028", "\u2029", "\u202a", "\u202b", "\u202c", "\u202d",   "\u202e",   "\u2060",
        "\u2066", "\u2067", "\u2068", "\u2069", "\ufeff", "\ufff9",   "\uffff",   "\U000e0041"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char text[20] = "a";
        strcat(text, bad[i]);
        strcat(text, "b");
        assert_int_equal(shear_text_shown(bad[i]), 0);
        expect(text, "a?b");
    }
}

static void test_no_utf8(void **state) {
    (void)state;
    expect("\xff", "?");
    expect("a\xc3", "a?");
    expect("\xc0\xaf", "??");           /* overlong */
    expect("\xed\xa0\x80", "???");      /* a surrogate */
    expect("\xf4\x90\x80\x80", "????"); /* beyond Unicode */
    expect("\xe2\x80", "??");           /* cut off */
    expect("\x9b"
           "31m",
           "?31m"); /* CSI of 8 bits */
}

static void test_cut(void **state) {
    (void)state;
    char buf[4];
    assert_string_equal(shear_text_clean("abcdef", buf, sizeof buf), "abc");
    assert_string_equal(shear_text_clean("ab\u00dc", buf, sizeof buf), "ab");
    assert_string_equal(shear_text_clean("a\u00dcb", buf, sizeof buf), "a\u00dc");
    assert_string_equal(shear_text_clean("abc", buf, 1), "");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shown), cmocka_unit_test(test_hidden),
                                       cmocka_unit_test(test_no_utf8), cmocka_unit_test(test_cut)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

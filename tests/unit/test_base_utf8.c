/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The decoder against an encoder, over all of Unicode; and ill-formed input. */
#include "base/utf8.h"
#include "test.h"

#include <stdbool.h>

static size_t encode(uint32_t point, char *out) {
    const size_t n = point < 0x80 ? 1 : point < 0x800 ? 2 : point < 0x10000 ? 3 : 4;
    static const unsigned char mark[] = {0, 0, 0xc0, 0xe0, 0xf0};
    for (size_t i = n; i-- > 1;) {
        out[i] = (char)(0x80 | (point & 0x3f));
        point >>= 6;
    }
    out[0] = (char)(mark[n] | point);
    out[n] = '\0';
    return n;
}

static void every_point_is_read_back(void **state) {
    (void)state;
    for (uint32_t point = 1; point <= 0x110000; point++) {
        char text[5];
        uint32_t back = 0;
        const size_t n = encode(point, text);
        const bool good = point < 0xd800 || (point > 0xdfff && point <= 0x10ffff);
        if (utf8_decode(text, &back) != (good ? n : 0) || (good && back != point))
            fail_msg("U+%04X", point);
    }
}

static void the_rest_is_refused(void **state) {
    (void)state;
    static const char *const bad[] = {
        "\x80",         "\xbf",         "\xc0\xaf", "\xc1\xbf",
        "\xe0\x9f\xbf", "\xf0\x8f\xbf", "\xf5\x80", "\xf8\x88\x80\x80",
        "\xff",         "\xc3",         "\xe2\x82", "\xf0\x9f",
        "\xc3(",        "\xe2(\xa1"};
    uint32_t point = 0;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(utf8_decode(bad[i], &point), 0);
    assert_int_equal(utf8_decode("", &point), 1);
    assert_int_equal(point, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_point_is_read_back),
                                       cmocka_unit_test(the_rest_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

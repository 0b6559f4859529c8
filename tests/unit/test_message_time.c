/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Times as text (RFC 3339) there and back, and texts that are no times. */
#include "rpc_fixture.h"
#include "test.h"

#include <string.h>

static void test_times(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int64_t ms;
    } known[] = {
        {"1970-01-01T00:00:00.000Z", 0},
        {"1970-01-01T00:00:00Z", 0},
        {"1969-12-31T23:59:59.999Z", -1},
        {"2000-02-29T12:00:00.5Z", INT64_C(951825600500)},
        {"2026-11-22T00:19:03.123Z", INT64_C(1795306743123)},
        {"2026-11-22t01:49:03.1239z", INT64_C(1795312143123)},
        {"2026-11-22T01:49:03.123+01:30", INT64_C(1795306743123)},
        {"2026-11-21T16:19:03.123-08:00", INT64_C(1795306743123)},
        {"2016-12-31T23:59:60Z", INT64_C(1483228800000)},
        {"9999-12-31T23:59:59.999Z", INT64_C(253402300799999)},
        {"0000-01-01T00:00:00.000Z", INT64_C(-62167219200000)},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        int64_t ms = 1;
        assert_true(sheard_time_parse(&ms, known[i].text));
        assert_int_equal(ms, known[i].ms);
        char text[SHEARD_TIME_SIZE];
        int64_t again = 1;
        assert_true(sheard_time_parse(&again, sheard_time_format(ms, text)));
        assert_int_equal(again, ms);
        assert_int_equal(strlen(text), strlen("2026-11-22T00:19:03.123Z"));
    }
    char text[SHEARD_TIME_SIZE];
    assert_string_equal(sheard_time_format(INT64_C(1795306743123), text),
                        "2026-11-22T00:19:03.123Z");
    assert_string_equal(sheard_time_format(-1, text), "1969-12-31T23:59:59.999Z");
    assert_string_equal(sheard_time_format(INT64_MAX, text), "9999-12-31T23:59:59.999Z");
    assert_string_equal(sheard_time_format(INT64_MIN, text), "0000-01-01T00:00:00.000Z");
}

static void test_bad_times(void **state) {
    (void)state;
    static const char *const bad[] = {
        "",
        "2026-11-22",
        "2026-11-22 00:00:00Z",
        "2026-11-22T00:00:00",
        "2026-13-22T00:00:00Z",
        "2026-00-22T00:00:00Z",
        "2026-02-29T00:00:00Z",
        "1900-02-29T00:00:00Z",
        "2026-11-31T00:00:00Z",
        "2026-11-22T24:00:00Z",
        "2026-11-22T00:60:00Z",
        "2026-11-22T00:00:61Z",
        "2026-11-22T00:00:00.Z",
        "2026-11-22T00:00:00+1:00",
        "2026-11-22T00:00:00+24:00",
        "2026-11-22T00:00:00Zx",
        "26-11-22T00:00:00Z",
        "-026-11-22T00:00:00Z",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        int64_t ms = 0;
        if (sheard_time_parse(&ms, bad[i]))
            fail_msg("\"%s\" was taken as a time", bad[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_times),
        cmocka_unit_test(test_bad_times),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

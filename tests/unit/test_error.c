/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors: codes, messages too long for their place, prefixes, and no error struct at all. */
#include "test.h"

#include "shear/error.h"
#include "shear/version.h"

#include <string.h>

/* An error with a canary behind it. */
typedef struct guarded {
    shear_error err;
    char canary[64];
} guarded;

static void guarded_init(guarded *g) {
    memset(g, 'x', sizeof *g);
}

static void assert_canary(const guarded *g) {
    for (size_t i = 0; i < sizeof g->canary; i++)
        assert_true(g->canary[i] == 'x');
}

static void test_fail(void **state) {
    (void)state;
    guarded g;
    guarded_init(&g);
    assert_int_equal(shear_fail(&g.err, SHEAR_E_IO, "try %s", "file '%s', HDU %d", "a.fits", 3),
                     SHEAR_E_IO);
    assert_int_equal(g.err.code, SHEAR_E_IO);
    assert_string_equal(g.err.message, "file 'a.fits', HDU 3");
    assert_string_equal(g.err.advice, "try %s"); /* an advice is no format */
    assert_int_equal(shear_fail(&g.err, SHEAR_E_PSF, NULL, "x"), SHEAR_E_PSF);
    assert_string_equal(g.err.advice, "");
    assert_int_equal(shear_fail(NULL, SHEAR_E_PSF, "y", "x"), SHEAR_E_PSF);
    assert_canary(&g);
}

static void test_long_messages(void **state) {
    (void)state;
    char text[3000];
    guarded g;
    for (size_t length = 0;
         length<sizeof text - 1; length += length> 200 && length < 1000 ? 1 : 97) {
        guarded_init(&g);
        memset(text, 'm', length);
        text[length] = '\0';
        shear_fail(&g.err, SHEAR_E_IO, text, "%s", text);
        const size_t room = sizeof g.err.message - 1;
        const size_t advice = sizeof g.err.advice - 1;
        assert_int_equal(strlen(g.err.message), length < room ? length : room);
        assert_int_equal(strlen(g.err.advice), length < advice ? length : advice);
        assert_canary(&g);
    }
}

/* prefix + ": " + message, cut at the end where it does not fit. */
static void test_prefix(void **state) {
    (void)state;
    char prefix[1200];
    char message[1200];
    char whole[3000];
    static const size_t lengths[] = {0,   1,   100, 236, 237, 238, 239,
                                     240, 477, 478, 479, 480, 481, 1000};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        for (size_t j = 0; j < sizeof lengths / sizeof lengths[0]; j++) {
            guarded g;
            guarded_init(&g);
            memset(prefix, 'p', lengths[i]);
            memset(message, 'm', lengths[j]);
            prefix[lengths[i]] = message[lengths[j]] = '\0';
            shear_fail(&g.err, SHEAR_E_FORMAT, "advice", "%s", message);
            assert_int_equal(shear_prefix(&g.err, SHEAR_E_IO, "%s", prefix), SHEAR_E_FORMAT);
            strcpy(whole, prefix);
            strcat(whole, ": ");
            strcat(whole, message);
            whole[sizeof g.err.message - 1] = '\0';
            assert_memory_equal(g.err.message, whole,
                                strlen(whole) < 479 ? strlen(whole) + 1 : 479);
            assert_true(g.err.message[sizeof g.err.message - 1] == '\0' ||
                        strlen(g.err.message) < 479);
            assert_string_equal(g.err.advice, "advice");
            assert_canary(&g);
        }
    }
    assert_int_equal(shear_prefix(NULL, SHEAR_E_IO, "x"), SHEAR_E_IO);
}

static void test_code_names(void **state) {
    (void)state;
    for (int code = SHEAR_OK; code <= SHEAR_E_FULL; code++) {
        assert_string_not_equal(shear_code_name(code), "unknown");
        for (int other = SHEAR_OK; other < code; other++)
            assert_string_not_equal(shear_code_name(code), shear_code_name(other));
    }
    assert_string_equal(shear_code_name(-1), "unknown");
    assert_string_equal(shear_code_name(SHEAR_E_FULL + 1), "unknown");
}

static void test_version(void **state) {
    (void)state;
    assert_string_equal(shear_version(), SHEAR_VERSION_STRING);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fail),    cmocka_unit_test(test_long_messages),
        cmocka_unit_test(test_prefix),  cmocka_unit_test(test_code_names),
        cmocka_unit_test(test_version),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

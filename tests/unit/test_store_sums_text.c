/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packing is exact for any text, and small for the texts it is made for. */
#include "store/sums_text.h"
#include "store_test.h"

#include <stdlib.h>
#include <string.h>

static void round_trip(const char *text) {
    shear_error err = {0};
    char *packed = NULL;
    char *back = NULL;
    FX_OK(sums_pack(text, &packed, &err));
    FX_OK(sums_unpack(packed, &back, &err));
    assert_string_equal(back, text);
    assert_true(strlen(packed) <= strlen(text) + 2);
    free(packed);
    free(back);
}

static void any_text(void **state) {
    static const char *const texts[] = {
        "",    "0",     "00000", "000000",   "0000000",        "1000000",     "0000001",    "z",
        "z6.", "z:z6.", "1.5",   " 000000 ", "000000.000000.", "00000 00000", "-00000000 a"};
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        round_trip(texts[i]);
    char zeros[2000];
    for (size_t n = 0; n < sizeof zeros; n++) {
        memset(zeros, '0', n);
        zeros[n] = '\0';
        round_trip(zeros);
    }
}

static void sums_become_small(void **state) {
    (void)state;
    for (unsigned seed = 0; seed < 50; seed++) {
        shear_error err = {0};
        char *packed = NULL;
        char *text = fx_sums(seed);
        round_trip(text);
        FX_OK(sums_pack(text, &packed, &err));
        assert_true(strlen(packed) < 2560);
        free(packed);
        free(text);
    }
}

static void bad_ones_are_refused(void **state) {
    static const char *const bad[] = {"",
                                      "0",
                                      "z:z",
                                      "z:z.",
                                      "z:z0.",
                                      "z:z7",
                                      "z:z7,",
                                      "z:1z-.",
                                      "z:z65537.",
                                      "z:zz6.",
                                      "z:z99999999999999999999.",
                                      "z:z40000.1z40000."};
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_error err = {0};
        char *text = (char *)&err;
        FX_CODE(SHEAR_E_FORMAT, sums_unpack(bad[i], &text, &err));
        assert_null(text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_text),
        cmocka_unit_test(sums_become_small),
        cmocka_unit_test(bad_ones_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

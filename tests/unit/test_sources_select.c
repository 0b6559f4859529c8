/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row expressions: which sources are selected, compared with the same condition in C; and what is
 * refused before CFITSIO sees it. */
#include "source_fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void test_flags(void **state) {
    (void)state;
    const char *path = fixture_path("flags.cat");
    source_fixture_write(path, 80);
    const shear_exposure named = {.origin = 1, .select = "flags == 5 || X_IMAGE < 20"};
    source_list s = source_fixture_read(path, &named);
    for (int64_t i = 0; i < s.n; i++)
        assert_int_equal(s.selected[i], i % 8 == 5 || s.x[i] < 20.0);
    source_list_deinit(&s);
    const shear_exposure other = {.origin = 1, .select = "MAG_AUTO > 19.6"};
    s = source_fixture_read(path, &other);
    for (int64_t i = 0; i < s.n; i++)
        assert_int_equal(s.selected[i], i % 8 < 4 && 18.0 + (double)(i % 10) * 0.5 > 19.6);
    source_list_deinit(&s);
}

static void test_refused(void **state) {
    (void)state;
    const char *path = fixture_path("refused.cat");
    source_fixture_write(path, 8);
    shear_exposure e = {.origin = 1, .select = "gtifilter('/etc/passwd')"};
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "gtifilter", "function", "sqrt", NULL);
    e.select = "@/etc/passwd";
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "@", NULL);
    e.select = "X_IMGE > 3";
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "X_IMGE", "did you mean X_IMAGE", NULL);
    e.select = "X_IMAGE >";
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "X_IMAGE >", "CFITSIO", "MAG_AUTO", NULL);
    e.select = "X_IMAGE";
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "logical", NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flags),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}

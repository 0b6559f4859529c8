/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggestions for misspelled names. */
#include "base/spelling.h"
#include "test.h"

#include <stddef.h>

static const char *best_of(const char *given, const char *const *candidates) {
    spelling s = {.given = given};
    for (; *candidates != NULL; candidates++)
        spelling_consider(&s, *candidates);
    return s.best;
}

static void names_are_the_same(void **state) {
    (void)state;
    assert_true(spelling_same("beta-ratio", "beta_ratio"));
    assert_true(spelling_same("", ""));
    assert_false(spelling_same("beta", "Beta"));
    assert_false(spelling_same("beta", "beta-"));
    assert_false(spelling_same("beta-x", "beta"));
}

static void the_nearest_is_named(void **state) {
    (void)state;
    static const char *const names[] = {"plot", "measure", "validate", "log_level", NULL};
    assert_string_equal(best_of("mesure", names), "measure");
    assert_string_equal(best_of("maesure", names), "measure");
    assert_string_equal(best_of("LOG-LEVLE", names), "log_level");
    assert_string_equal(best_of("plt", names), "plot");
}

static void others_are_not(void **state) {
    (void)state;
    static const char *const names[] = {"plot", "measure", NULL};
    static const char *const twins[] = {"cat", "bat", NULL};
    assert_null(best_of("nothing", names));
    assert_null(best_of("a name that is much longer than any name can be, really", names));
    assert_string_equal(best_of("at", twins), "cat");
}

static void words_are_found(void **state) {
    (void)state;
    static const char *const words[] = {"one", "log_mean", "three", NULL};
    assert_int_equal(spelling_find(words, "one"), 0);
    assert_int_equal(spelling_find(words, "log-mean"), 1);
    assert_int_equal(spelling_find(words, "on"), -1);
    assert_int_equal(spelling_find(words, "One"), -1);
    assert_int_equal(spelling_find(words + 3, ""), -1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_the_same),
        cmocka_unit_test(words_are_found),
        cmocka_unit_test(the_nearest_is_named),
        cmocka_unit_test(others_are_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

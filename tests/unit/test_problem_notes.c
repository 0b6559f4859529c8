/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recent failures: one note per problem, and a limited number of lines about it in the log. */
#include "service/core/problem_notes.h"
#include "test.h"

#include <stdio.h>

static void the_same_trouble_is_one_note(void **state) {
    (void)state;
    problem_notes all = {0};
    problem_note_add(&all, "jobs", "io", 60000, "first");
    problem_note_add(&all, "jobs", "io", 60000, "second");
    problem_note_add(&all, "store", "io", 60000, "third");
    assert_int_equal(problem_note_find(&all, "jobs", "io")->count, 2);
    assert_string_equal(problem_note_find(&all, "jobs", NULL)->message, "second");
    assert_null(problem_note_find(&all, "jobs", "other"));
    problem_note_end(&all, "jobs");
    assert_null(problem_note_find(&all, "jobs", NULL));
    assert_non_null(problem_note_find(&all, "store", NULL));
}

static void a_note_ends(void **state) {
    (void)state;
    problem_notes all = {0};
    problem_note_add(&all, "jobs", "io", 0, "over at once");
    assert_null(problem_note_find(&all, "jobs", "io"));
    problem_note_add(&all, "store", "io", INT64_MAX, "until it is ended");
    assert_non_null(problem_note_find(&all, "store", "io"));
}

static void the_one_that_ends_first_makes_room(void **state) {
    (void)state;
    problem_notes all = {0};
    char code[16];
    for (int i = 0; i < PROBLEM_NOTES; i++) {
        snprintf(code, sizeof code, "c%d", i);
        problem_note_add(&all, "jobs", code, 60000 + 1000 * i, "waits");
    }
    problem_note_add(&all, "jobs", "new", 60000, "waits");
    assert_null(problem_note_find(&all, "jobs", "c0"));
    assert_non_null(problem_note_find(&all, "jobs", "c1"));
    assert_non_null(problem_note_find(&all, "jobs", "new"));
}

static void a_burst_is_logged_in_part(void **state) {
    (void)state;
    problem_notes all = {0};
    int logged = 0;
    problem_note_add(&all, "jobs", "io", 60000, "waits");
    for (int i = 0; i < 20; i++)
        logged += problem_note_may_log(&all, "jobs", "io");
    assert_int_equal(logged, 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_trouble_is_one_note),
        cmocka_unit_test(a_note_ends),
        cmocka_unit_test(the_one_that_ends_first_makes_room),
        cmocka_unit_test(a_burst_is_logged_in_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Growth of arrays and buffers; arenas; release of locals. */
#include "base/arena.h"
#include "base/array.h"
#include "base/buffer.h"
#include "base/cleanup.h"
#include "test.h"

#include <stdint.h>
#include <string.h>

static void growing_keeps_the_items(void **state) {
    (void)state;
    CLEANUP(release_free) int *items = NULL;
    size_t capacity = 0;
    for (size_t n = 0; n < 1000; n++) {
        assert_true(ARRAY_RESERVE(items, capacity, n + 1));
        assert_true(capacity > n);
        items[n] = (int)n;
    }
    for (size_t i = 0; i < 1000; i++)
        assert_int_equal(items[i], (int)i);
    assert_true(capacity < 2048);
}

static void nothing_changes_where_nothing_is_needed(void **state) {
    (void)state;
    CLEANUP(release_free) double *items = NULL;
    size_t capacity = 0;
    assert_true(ARRAY_RESERVE(items, capacity, 0));
    assert_null(items);
    assert_true(ARRAY_RESERVE(items, capacity, 100));
    assert_int_equal(capacity, 100);
    double *const before = items;
    assert_true(ARRAY_RESERVE(items, capacity, 100));
    assert_ptr_equal(items, before);
}

static int compare_ints(const void *key, const void *item) {
    const int a = *(const int *)key;
    const int b = *(const int *)item;
    return (a > b) - (a < b);
}

static void the_first_that_is_not_before_the_key(void **state) {
    (void)state;
    enum { N = 9 };
    const int items[N] = {1, 3, 3, 3, 5, 7, 9, 9, 11};
    for (size_t n = 0; n <= N; n++) {
        for (int key = 0; key <= 12; key++) {
            size_t expected = 0;
            while (expected < n && items[expected] < key)
                expected++;
            assert_int_equal(array_lower_bound(items, n, sizeof *items, &key, compare_ints),
                             expected);
        }
    }
    const int key = 1;
    assert_int_equal(array_lower_bound(NULL, 0, sizeof *items, &key, compare_ints), 0);
}

static void scratch_is_no_larger_than_needed(void **state) {
    (void)state;
    CLEANUP(release_free) double *items = NULL;
    size_t capacity = 0;
    assert_true(ARRAY_RESERVE_EXACT(items, capacity, 3));
    assert_int_equal(capacity, 3);
    assert_true(ARRAY_RESERVE_EXACT(items, capacity, 4));
    assert_int_equal(capacity, 4);
    assert_true(ARRAY_RESERVE_EXACT(items, capacity, 2));
    assert_int_equal(capacity, 4);
}

static void too_many_are_refused(void **state) {
    (void)state;
    CLEANUP(release_free) double *items = NULL;
    size_t capacity = 0;
    assert_true(ARRAY_RESERVE(items, capacity, 1));
    double *const before = items;
    const size_t had = capacity;
    assert_false(ARRAY_RESERVE(items, capacity, SIZE_MAX / 4));
    assert_false(ARRAY_RESERVE(items, capacity, SIZE_MAX));
    assert_ptr_equal(items, before);
    assert_int_equal(capacity, had);
}

static void a_buffer_collects(void **state) {
    (void)state;
    buffer b = {0};
    size_t n = 0;
    for (int i = 0; i < 500; i++) {
        assert_true(buffer_add_text(&b, "ab"));
        assert_true(buffer_add(&b, "", 1));
    }
    assert_true(buffer_add(&b, NULL, 0));
    CLEANUP(release_free) char *bytes = buffer_take(&b, &n);
    assert_non_null(bytes);
    assert_int_equal(n, 1500);
    assert_memory_equal(bytes + 1497, "ab\0", 4);
    assert_null(b.bytes);
    assert_int_equal(b.n, 0);
}

static void a_failed_buffer_gives_nothing(void **state) {
    (void)state;
    buffer b = {0};
    assert_true(buffer_add_text(&b, "kept"));
    assert_false(buffer_add(&b, "", SIZE_MAX));
    assert_false(buffer_add_text(&b, "more"));
    assert_null(buffer_take(&b, NULL));
    assert_null(b.bytes);
    buffer_deinit(&b);
}

static int released;

static void thing_free(int *thing) {
    released += thing != NULL ? *thing : 0;
}

typedef int thing;
CLEANUP_DEFINE(thing, thing_free)

static int *own(int *one, int *other) {
    CLEANUP(thing_release) thing *kept = one;
    CLEANUP(thing_release) thing *given = other;
    CLEANUP(thing_release) thing *none = NULL;
    return kept != NULL && none == NULL ? CLEANUP_TAKE(given) : NULL;
}

static void locals_are_released_unless_taken(void **state) {
    (void)state;
    int one = 1;
    int other = 2;
    released = 0;
    assert_ptr_equal(own(&one, &other), &other);
    assert_int_equal(released, 1);
}

/* Arrays of an arena are zeros, aligned, and apart from each other; counted before, they fit. */
static void an_arena_holds_what_it_counted(void **state) {
    (void)state;
    arena a = {0};
    for (size_t n = 0; n < 300; n++)
        assert_null(arena_take(&a, n));
    const size_t counted = a.used;
    CLEANUP(release_free) char *memory = arena_allocate(&a);
    assert_non_null(memory);
    const char *end = memory;
    for (size_t n = 0; n < 300; n++) {
        char *taken = arena_take(&a, n);
        assert_true((uintptr_t)taken % 64 == 0 && taken >= end);
        for (size_t i = 0; i < n; i++)
            assert_true(taken[i] == 0);
        memset(taken, 1, n);
        end = taken + n;
    }
    assert_true(a.used == counted && end <= memory + counted);
    assert_true((char *)arena_doubles(&(arena){.memory = memory}, 1) == memory);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(growing_keeps_the_items),
        cmocka_unit_test(an_arena_holds_what_it_counted),
        cmocka_unit_test(nothing_changes_where_nothing_is_needed),
        cmocka_unit_test(the_first_that_is_not_before_the_key),
        cmocka_unit_test(scratch_is_no_larger_than_needed),
        cmocka_unit_test(too_many_are_refused),
        cmocka_unit_test(a_buffer_collects),
        cmocka_unit_test(a_failed_buffer_gives_nothing),
        cmocka_unit_test(locals_are_released_unless_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

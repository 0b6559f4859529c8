/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which solved results are kept: those requested last, and whatever a pending request needs. */
#include "service/fields/estimate_cache.h"
#include "test.h"

#include <stdio.h>

enum { MANY = 1500, KEPT = 1024 };

static estimate *request(estimate_cache *c, int number) {
    char name[16];
    char digest[] = "0";
    snprintf(name, sizeof name, "f%d", number);
    return estimate_cache_request(c, &(store_field){.name = name, .settings_digest = digest});
}

static const estimate *find(const estimate_cache *c, int number) {
    char name[16];
    char digest[] = "0";
    snprintf(name, sizeof name, "f%d", number);
    return estimate_cache_find(c, &(store_field){.name = name, .settings_digest = digest});
}

static void the_least_recently_requested_go(void **state) {
    (void)state;
    estimate_cache c;
    estimate_cache_init(&c);
    for (int i = 0; i < MANY; i++)
        assert_non_null(request(&c, i));
    const estimate *first = request(&c, 0);
    estimate_cache_shrink(&c, INT64_MAX);
    assert_int_equal(c.n, KEPT);
    assert_ptr_equal(find(&c, 0), first);
    assert_null(find(&c, 1));
    assert_null(find(&c, MANY - KEPT));
    assert_non_null(find(&c, MANY - KEPT + 1));
    estimate_cache_deinit(&c);
}

static void what_is_needed_stays(void **state) {
    (void)state;
    estimate_cache c;
    estimate_cache_init(&c);
    for (int i = 0; i < MANY; i++)
        assert_non_null(request(&c, i));
    estimate_cache_shrink(&c, 100); /* a pending request needs all that were requested after 100 */
    assert_int_equal(c.n, MANY - 100);
    request(&c, 100)->state = ESTIMATE_SOLVING;
    for (int i = 101; i < MANY; i++)
        request(&c, i);
    estimate_cache_shrink(&c, INT64_MAX); /* the oldest is being solved */
    assert_int_equal(c.n, MANY - 100);
    estimate_cache_deinit(&c);
}

static void settings_tell_fields_apart(void **state) {
    (void)state;
    estimate_cache c;
    char name[] = "f";
    char one[] = "1";
    char two[] = "2";
    const store_field a = {.name = name, .settings_digest = one};
    const store_field b = {.name = name, .settings_digest = two};
    estimate_cache_init(&c);
    assert_ptr_equal(estimate_cache_request(&c, &a), estimate_cache_request(&c, &a));
    assert_null(estimate_cache_find(&c, &b));
    assert_ptr_not_equal(estimate_cache_request(&c, &b), estimate_cache_find(&c, &a));
    assert_int_equal(c.n, 2);
    estimate_cache_deinit(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_least_recently_requested_go),
        cmocka_unit_test(what_is_needed_stays),
        cmocka_unit_test(settings_tell_fields_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

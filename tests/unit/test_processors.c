/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What control groups and affinity leave of the machine's processors. */
#include "engine/machine.h"
#include "remove_tree.h"
#include "test.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char top[128];

static int setup(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(top, sizeof top, "%.80s/sheard-processors-XXXXXX", base != NULL ? base : "/tmp");
    return mkdtemp(top) != NULL ? 0 : -1;
}

static int teardown(void **state) {
    (void)state;
    return remove_tree(top);
}

static const char *put(const char *name, const char *text) {
    static char path[400];
    snprintf(path, sizeof path, "%s/%s", top, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
    return path;
}

static int quota_of(const char *membership) {
    return machine_cgroup_quota(put("membership", membership), top);
}

static void the_least_quota_on_the_way(void **state) {
    (void)state;
    char path[400];
    snprintf(path, sizeof path, "%s/system.slice", top);
    assert_int_equal(mkdir(path, 0755), 0);
    snprintf(path, sizeof path, "%s/system.slice/sheard.service", top);
    assert_int_equal(mkdir(path, 0755), 0);
    const char *service = "0::/system.slice/sheard.service\n";
    assert_int_equal(quota_of(service), 0);
    put("system.slice/sheard.service/cpu.max", "max 100000\n");
    assert_int_equal(quota_of(service), 0);
    put("system.slice/sheard.service/cpu.max", "250000 100000\n");
    assert_int_equal(quota_of(service), 3);
    put("system.slice/cpu.max", "800000 100000\n");
    assert_int_equal(quota_of(service), 3);
    put("cpu.max", "50000 100000\n");
    assert_int_equal(quota_of(service), 1);
    assert_int_equal(quota_of("0::/\n"), 1); /* in a container */
    assert_int_equal(quota_of("12:cpu:/old\n0::/system.slice\n"), 1);
}

static void what_cannot_be_read_is_no_quota(void **state) {
    (void)state;
    put("cpu.max", "200000 100000\n");
    assert_int_equal(quota_of("0::/nowhere/at/all\n"), 2);
    assert_int_equal(quota_of("12:cpu:/old\n"), 0);
    assert_int_equal(quota_of(""), 0);
    assert_int_equal(machine_cgroup_quota("/nonexistent", top), 0);
    const char *const bad[] = {"", "x", "-1 100000", "100000 0", "100000", "99999999999999999 1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        put("cpu.max", bad[i]);
        assert_int_equal(quota_of("0::/\n"), 0);
    }
}

static void affinity_counts(void **state) {
    (void)state;
    cpu_set_t all;
    cpu_set_t one;
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    assert_in_range(machine_processors(), 1, (unsigned long)CPU_COUNT(&all));
    size_t first = 0;
    while (!CPU_ISSET(first, &all))
        first++;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    assert_int_equal(machine_processors(), 1);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_least_quota_on_the_way, setup, teardown),
        cmocka_unit_test_setup_teardown(what_cannot_be_read_is_no_quota, setup, teardown),
        cmocka_unit_test(affinity_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

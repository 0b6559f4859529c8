/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The memory that control groups leave a process: the least limit on the way up counts. */
#include "engine/machine.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

static char root[64] = "/tmp/shear-machine-XXXXXX";

static char *at(const char *name) {
    static char path[4][300];
    static int turn = 0;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s%s", root, name);
    return path[turn];
}

static void put(const char *name, const char *text) {
    FILE *f = fopen(at(name), "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
}

static int64_t least(const char *membership) {
    put("/self", membership);
    return machine_cgroup_memory(at("/self"), root);
}

static void test_least_on_the_way_up(void **state) {
    (void)state;
    assert_int_equal(least("0::/a/b\n"), INT64_MAX);
    mkdir(at("/a"), 0700);
    mkdir(at("/a/b"), 0700);
    put("/a/b/memory.max", "max\n");
    assert_int_equal(least("0::/a/b\n"), INT64_MAX);
    put("/a/memory.max", "3000\n");
    assert_int_equal(least("0::/a/b\n"), 3000);
    put("/a/b/memory.high", "2000\n");
    assert_int_equal(least("0::/a/b\n"), 2000);
    assert_int_equal(least("0::/a\n"), 3000);
    put("/memory.max", "1000\n");
    assert_int_equal(least("0::/a/b\n"), 1000);
    assert_int_equal(least("0::/\n"), 1000);
    assert_int_equal(least("12:memory:/a\n0::/a/b\n"), 1000);
}

static void test_odd_files(void **state) {
    (void)state;
    assert_int_equal(machine_cgroup_memory(at("/absent"), root), 1000); /* the root's own */
    assert_int_equal(machine_cgroup_memory(at("/absent"), at("/absent")), INT64_MAX);
    put("/memory.max", "nonsense\n");
    assert_int_equal(least("0::/\n"), INT64_MAX);
    put("/memory.max", "0\n");
    assert_int_equal(least("0::/\n"), INT64_MAX);
}

static void test_address_space(void **state) {
    (void)state;
    const int64_t all = machine_memory();
    struct rlimit before;
    assert_true(all > 0);
    assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
    const struct rlimit half = {.rlim_cur = (rlim_t)all / 2, .rlim_max = before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_AS, &half), 0);
    const int64_t less = machine_memory();
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    assert_int_equal(less, all / 2);
}

static int make_root(void **state) {
    (void)state;
    return mkdtemp(root) != NULL ? 0 : -1;
}

static int remove_root(void **state) {
    (void)state;
    char command[100];
    snprintf(command, sizeof command, "rm -rf %s", root);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_least_on_the_way_up),
        cmocka_unit_test(test_odd_files),
        cmocka_unit_test(test_address_space),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}

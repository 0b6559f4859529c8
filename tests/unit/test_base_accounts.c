/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Users and groups by name, and the directory of this program. */
#include "base/accounts.h"
#include "base/io.h"
#include "test.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static void names_are_found(void **state) {
    (void)state;
    uid_t uid = 7;
    gid_t gid = 7;
    assert_int_equal(accounts_find_user("nobody-of-this-name", &uid), ENOENT);
    assert_int_equal(accounts_find_group("no-group-of-this-name", &gid), ENOENT);
    assert_int_equal(uid, 7);
    assert_int_equal(gid, 7);
    assert_int_equal(accounts_find_user("root", &uid), 0);
    assert_int_equal(accounts_find_group("root", &gid), 0);
    assert_int_equal(uid, 0);
    assert_int_equal(gid, 0);
}

static void this_program_is_there(void **state) {
    (void)state;
    char path[4096];
    assert_int_equal(io_own_directory(path, sizeof path), 0);
    const size_t n = strlen(path);
    assert_int_equal(path[0], '/');
    strcat(path, "/test_base_accounts");
    assert_int_equal(access(path, X_OK), 0);
    assert_int_equal(io_own_directory(path, n), ENAMETOOLONG);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_found),
        cmocka_unit_test(this_program_is_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

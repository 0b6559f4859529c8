/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Root and the state directory of somebody else. */
#include "service/core/directory.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NOBODY = 65534 };

static void whose_is_it(void **state) {
    (void)state;
    char top[] = "/tmp/sheard-owner-XXXXXX";
    char dir[64];
    shear_error err = {0};
    assert_non_null(mkdtemp(top));
    snprintf(dir, sizeof dir, "%s/state", top);
    if (geteuid() != 0) {
        assert_int_equal(directory_check_owner("/", "/", "root", &err), SHEAR_OK);
        assert_int_equal(directory_check_owner(dir, dir, "root", &err), SHEAR_OK);
        rmdir(top);
        return;
    }
    /* Not there: root may make it, unless a service's user would look for it there. */
    assert_int_equal(directory_check_owner(dir, "/var/lib/sheard", "nobody", &err), SHEAR_OK);
    assert_int_equal(directory_check_owner(dir, dir, "no-such-user-here", &err), SHEAR_OK);
    assert_int_equal(directory_check_owner(dir, dir, "nobody", &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, dir));
    assert_non_null(strstr(err.advice, "runuser -u nobody"));
    assert_int_equal(mkdir(dir, 0750), 0);
    assert_int_equal(directory_check_owner(dir, dir, "nobody", &err), SHEAR_OK); /* root's own */
    assert_int_equal(chown(dir, NOBODY, NOBODY), 0);
    assert_int_equal(directory_check_owner(dir, "/var/lib/sheard", "sheard", &err),
                     SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "'nobody'"));
    assert_int_equal(chown(dir, 4242421, NOBODY), 0);
    assert_int_equal(directory_check_owner(dir, "/var/lib/sheard", "sheard", &err),
                     SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "4242421"));
    rmdir(dir);
    rmdir(top);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(whose_is_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

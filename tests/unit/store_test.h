/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_test.h: a test of the store: cmocka with an open store in *state. */
#pragma once

#include "store_fixture.h"
#include "test.h"

/* Setup and teardown: *state is a fixture with an open, empty store over the quick file system
 * (store_vfs.h). */
int fx_setup(void **state);
int fx_teardown(void **state);
/* The teardown audits the database first: no test may leave a contradiction. */

#define STORE_TEST(f) cmocka_unit_test_setup_teardown(f, fx_setup, fx_teardown)

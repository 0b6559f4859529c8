/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/access_fixture.h: a data root with a file in it, one beside it, and peers that are
 * made up: no other user is needed. */
#pragma once

#include "access/access.h"

#include <sys/types.h>

enum { ALICE = 54321, STAFF = 54322, TEAM = 54323, BOB = 54324 }; /* nobody's numbers */

typedef struct fixture {
    char top[128]; /* all may search it */
    char data[160], outside[160];
    access_roots *roots;
} fixture;

extern const access_peer alice;
extern const access_peer root_peer;

/* Setup and teardown: *state is a fixture. */
int access_setup(void **state);
int access_teardown(void **state);

#define ACCESS_TEST(name) cmocka_unit_test_setup_teardown(name, access_setup, access_teardown)

/* The path of a name in a directory; good for four calls. */
const char *at(const char *directory, const char *name);

void write_file(const char *path, const char *content, mode_t mode);
void make_directory(const char *path, mode_t mode);

/* Return the code of opening `path` for the peer; check its content if it opens. */
int try_open(const fixture *f, const access_peer *peer, const char *path, const char *content);

#define OPENS(peer, path, content) assert_int_equal(try_open(f, peer, path, content), SHEAR_OK)
#define REFUSES(peer, path, code)  assert_int_equal(try_open(f, peer, path, ""), code)

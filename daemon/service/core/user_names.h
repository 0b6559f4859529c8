/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/user_names.h: names of users, cached for a minute: a look-up in the user database
 * may be slow, and lists have thousands of jobs. */
#pragma once

#include <stdint.h>
#include <sys/types.h>

enum { KNOWN_USERS = 64 };

typedef struct known_user {
    int64_t until_ms; /* when the entry expires; 0: empty */
    uid_t uid;
    char name[64]; /* "": the user has no name */
} known_user;

typedef struct user_names {
    known_user known[KNOWN_USERS];
} user_names;

/* Write the user's name, or its number if it has none, into out[size]. Waits for the user
 * database. */
void user_names_write(uid_t uid, char *out, size_t size);
/* Return the user's name, valid until the next call, or NULL if there is none. `now_ms` is of a
 * clock that is never set. */
const char *user_names_get(user_names *all, uid_t uid, int64_t now_ms);

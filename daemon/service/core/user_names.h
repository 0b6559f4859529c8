/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/user_names.h: names of users, remembered for a minute: asking the user database may
 * take long, and jobs are told by the thousand. */
#ifndef SHEARD_SERVICE_USER_NAMES_H
#define SHEARD_SERVICE_USER_NAMES_H

#include <stdint.h>
#include <sys/types.h>

enum { KNOWN_USERS = 64 };

typedef struct known_user {
    int64_t until_ms; /* 0: nothing is known */
    uid_t uid;
    char name[64]; /* empty: none */
} known_user;

typedef struct user_names {
    known_user known[KNOWN_USERS];
} user_names;

/* `now_ms`: of a clock that is never set. NULL: the user has no name. Borrowed until the next call.
 */
const char *user_names_get(user_names *all, uid_t uid, int64_t now_ms);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/accounts.h: find users and groups by name in the system's database, which may be a directory
 * server: a call may wait. Thread-safe. */
#pragma once

#include <sys/types.h>

/* Return 0, ENOENT if there is none, or another errno. *id is unchanged after an error. */
int accounts_find_user(const char *name, uid_t *id);
int accounts_find_group(const char *name, gid_t *id);

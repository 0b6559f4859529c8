/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/permission.h: check whether a peer may read or search the file of a descriptor. */
#pragma once

#include "access/access.h"

#include <sys/stat.h>

enum { PERMIT_READ = 4, PERMIT_SEARCH = 1 }; /* as in mode bits */

/* Return whether it is one of the peer's groups. */
bool peer_has_group(const access_peer *peer, gid_t gid);

/* Check by mode and access control list. `fd` may be O_PATH; *st receives the file's status. Return
 * 0 if the peer may, EACCES, or another errno if the file cannot be examined. */
int permission_check(int fd, const access_peer *peer, unsigned wanted, struct stat *st);

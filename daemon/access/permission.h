/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/permission.h: may this peer do that with the file behind this descriptor? */
#ifndef SHEARD_ACCESS_PERMISSION_H
#define SHEARD_ACCESS_PERMISSION_H

#include "access/access.h"

#include <sys/stat.h>

enum { PERMIT_READ = 4, PERMIT_SEARCH = 1 }; /* as in mode bits */

/* Is it one of the peer's groups? */
bool peer_has_group(const access_peer *peer, gid_t gid);

/* By mode and access control list. `fd` may be O_PATH; *st is left filled. Returns 0 (it may),
 * EACCES, or another errno where the file cannot be examined. */
int permission_check(int fd, const access_peer *peer, unsigned wanted, struct stat *st);

#endif

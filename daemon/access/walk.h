/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/walk.h: the way from / to an open file. */
#ifndef SHEARD_ACCESS_WALK_H
#define SHEARD_ACCESS_WALK_H

#include "access/access.h"

/* The path of an open file without links, as the kernel has it (from malloc). Returns 0 or errno.
 */
int walk_name(int fd, char **name);

/* Walk from / to `target` (a directory, or else a regular file) and see on every descriptor that
 * the peer may search; on the target itself, that it may search or read. *name (from malloc) is the
 * way, or NULL where it is not wanted. Returns 0; EACCES: the peer may not; EPERM: the service may
 * not; ENOENT: the way is gone; EAGAIN: names changed meanwhile, again and again; or another errno.
 */
int walk_check(int target, const access_peer *peer, char **name);

#endif

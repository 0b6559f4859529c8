/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/walk.h: check a peer's permission on every directory from / to an open file. */
#pragma once

#include "access/access.h"

/* Get the path of an open file from the kernel: without links, from malloc. Return 0 or errno. */
int walk_name(int fd, char **name);

/* Walk from / to `target`, and check on every descriptor that the peer may search the directory;
 * for the target itself, that it may search it, or read it if it is not a directory. *name (from
 * malloc) receives the path; `name` may be NULL. Return 0; EACCES if the peer may not; EPERM if the
 * service may not; ENOENT if the file has been removed; EAGAIN if names keep changing; or another
 * errno. */
int walk_check(int target, const access_peer *peer, char **name);

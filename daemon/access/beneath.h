/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/beneath.h: resolve a path beneath a directory, with its symbolic links, without leaving
 * that directory. */
#pragma once

#include "access/access.h"

/* Resolve `path` (relative, without "..") from the directory `root`, and return an O_PATH
 * descriptor or -errno. This is like openat2 with RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS, but uses
 * only calls that every sandbox allows (systemd's RestrictSUIDSGID forbids openat2). One component
 * at a time is opened from a descriptor, so that nothing can be exchanged between a check and the
 * next step. Links are resolved here: none may lead above the root, and absolute links count as
 * doing so. Nothing is looked up in a directory that the peer may not search.
 *
 * Errors: EACCES: the peer may not search a directory; EPERM: the service may not; EXDEV: a link
 * leads out; ELOOP: too many links or steps; ENAMETOOLONG, ENOENT, ENOTDIR, or another error of
 * openat.
 *
 * *link is the first character of the link's text if the last component of `path` that was tried is
 * a link, else '\0'. If an error comes with a link, it is about the link or its target, not about a
 * name in `path`. */
int beneath_open(int root, const char *path, const access_peer *peer, char *link);

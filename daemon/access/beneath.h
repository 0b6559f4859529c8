/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/beneath.h: resolving a path beneath a directory, links and all, without leaving it. */
#ifndef SHEARD_ACCESS_BENEATH_H
#define SHEARD_ACCESS_BENEATH_H

#include "access/access.h"

/* What `path` (relative, without "..") leads to from the directory `root`, as an O_PATH descriptor;
 * or -errno. As openat2 with RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS would, but by calls that every
 * sandbox leaves us (systemd's RestrictSUIDSGID takes openat2 away): a component at a time, on
 * descriptors only, so that nothing can be exchanged between a look and a step. Links are read
 * here: none may lead above the root, and absolute ones are taken to. In a directory that the peer
 * may not search nothing is looked up.
 *
 * EACCES: the peer may not search a directory; EPERM: the service may not; EXDEV: a link leads out;
 * ELOOP: too many links, or steps by them; ENAMETOOLONG; ENOENT, ENOTDIR, or another one of openat.
 *
 * *link: what the text of the last component of `path` that was tried begins with, where that is a
 * link, else '\0': where the call fails with a link, it is the link (or what it leads to) that
 * failed, not what the path names. */
int beneath_open(int root, const char *path, const access_peer *peer, char *link);

#endif

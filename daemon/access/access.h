/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/access.h: open files for clients only if the client itself may read them, and match peers
 * against the configured lists of users and groups.
 *
 * The service reads with its own rights. So that no client can use these to read the files of
 * others, the peer's rights are checked: owner, group and other bits, POSIX access control lists,
 * and search permission on every directory of the path. All checks use open descriptors, so that
 * nothing can be exchanged between a check and the use. Rights that only a file server has (NFSv4
 * lists, security modules) are not visible: the mode bits of the mount decide then.
 *
 * Thread-safe as long as no object is changed while in use. Calls wait for the disk; those that say
 * so also wait for the user database (maybe a directory server). */
#pragma once

#include "shear/error.h"
#include "sheard/config.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum access_code {
    ACCESS_E_PATH = 100, /* relative, with "..", or too long */
    ACCESS_E_OUTSIDE,    /* beneath no data root, or a link leads out of it */
    ACCESS_E_NOT_FOUND,
    ACCESS_E_DENIED,  /* the peer may not read it */
    ACCESS_E_SERVICE, /* the peer may read it, but the service may not */
    ACCESS_E_NOT_REGULAR,
    ACCESS_E_ROOT /* the data root is missing now */
};

/* ---- peers ---- */

typedef struct access_peer {
    uid_t uid; /* 0 may do everything */
    gid_t gid;
    gid_t *groups; /* [n_groups] supplementary groups; owned */
    size_t n_groups;
} access_peer;
void access_peer_deinit(access_peer *peer);

/* Get the user of the process that connected this Unix socket, as it was then. Return SHEAR_OK,
 * SHEAR_E_IO or SHEAR_E_NOMEM. */
int access_peer_from_socket(int socket, access_peer *peer, shear_error *err);
/* Get a user, such as the owner of a dropped file, from the user database. A uid without an entry
 * has no groups but `gid`. */
int access_peer_from_user(uid_t uid, gid_t gid, access_peer *peer, shear_error *err);

/* Write the supplementary groups as text ("4 27 1000", or "" for none), to be stored with the
 * peer's request. *text is from malloc. Return SHEAR_OK or SHEAR_E_NOMEM. */
int access_peer_groups_text(const access_peer *peer, char **text, shear_error *err);
/* Restore the peer from that text. Return SHEAR_OK, SHEAR_E_NOMEM, or SHEAR_E_INTERNAL if the text
 * is invalid. */
int access_peer_from_text(uid_t uid, gid_t gid, const char *groups, access_peer *peer,
                          shear_error *err);

/* ---- lists of users and groups ---- */

typedef struct access_list access_list;

/* Look up all names in the user database, once. A name may be a number. A name that the database
 * does not have (of a user who has left) matches nobody; access_list_unknown reports it. Return
 * SHEAR_OK, SHEAR_E_NOMEM, or SHEAR_E_IO if the database cannot be used. *list is NULL on error. */
int access_list_new(access_list **list, const sheard_list *users, const sheard_list *groups,
                    shear_error *err);
void access_list_free(access_list *list); /* NULL is accepted */
/* Return the warning about the i-th unknown name, or NULL after the last. */
const char *access_list_unknown(const access_list *list, size_t i);
/* Return whether the peer is one of the users or has one of the groups. False if the list is empty.
 */
bool access_list_has(const access_list *list, const access_peer *peer);

/* ---- files ---- */

typedef struct access_roots access_roots;

/* Store the data roots, absolute paths of directories. They may be missing: each is opened when it
 * is used, so that a disk may be mounted later. With no roots, every path is outside. Return
 * SHEAR_OK, SHEAR_E_SETTING or SHEAR_E_NOMEM; *roots is NULL on error. */
int access_roots_new(access_roots **roots, char *const *paths, size_t n, shear_error *err);
void access_roots_free(access_roots *roots); /* NULL is accepted */

/* Check that the service can open this root. Return SHEAR_OK or ACCESS_E_ROOT. */
int access_root_check(const char *path, shear_error *err);
/* Check all roots. Return SHEAR_OK, or ACCESS_E_ROOT for the first that is missing. */
int access_roots_check(const access_roots *roots, shear_error *err);

/* Open the regular file at `path` for reading, for `peer`. The path is absolute, without "..", and
 * beneath a root, by the root's configured name or by its name without symbolic links. Links
 * beneath a root are followed as long as they stay there; absolute links count as leaving it.
 * *canonical (from malloc) is the file's path without links.
 *
 * Return SHEAR_OK, enum access_code, SHEAR_E_IO or SHEAR_E_NOMEM; on an error *fd is -1 and
 * *canonical NULL. ACCESS_E_ROOT means that the path is beneath a root that is missing now. A path
 * in a directory that the peer may not search is denied, whether the file exists or not. */
int access_open(const access_roots *roots, const access_peer *peer, const char *path, int *fd,
                char **canonical, shear_error *err);

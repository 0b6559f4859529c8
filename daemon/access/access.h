/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/access.h: who may do what: files that a client names are opened for it only where the
 * client itself may read them, and the lists of users and groups of the configuration.
 *
 * The service reads with its own rights; so that it is nobody's deputy, it looks at the rights of
 * the peer: owner, group and other bits, POSIX access control lists, and search permission on every
 * directory on the way, all on open descriptors, so that nothing can be exchanged between the look
 * and the use. Rights that only a file server knows (NFSv4 lists, security modules) are not seen:
 * there the mode bits decide, as the mount shows them.
 *
 * Thread-safe as far as no object is changed while in use. Calls wait for the disk; those that say
 * so also for the user database (maybe a directory server).
 */
#ifndef SHEARD_ACCESS_H
#define SHEARD_ACCESS_H

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum access_code {
    ACCESS_E_PATH = 100, /* relative, with "..", too long */
    ACCESS_E_OUTSIDE,    /* beneath no data root, or a link leads out of it */
    ACCESS_E_NOT_FOUND,
    ACCESS_E_DENIED,  /* the peer may not read it */
    ACCESS_E_SERVICE, /* the peer may, but the service may not */
    ACCESS_E_NOT_REGULAR,
    ACCESS_E_ROOT /* the data root is not there now */
};
/* "bad_path", "outside_roots", "not_found", "permission_denied", "service_denied",
 * "not_regular", "root_missing"; else as shear_code_name. */
const char *access_code_name(int code);

/* ---- who is asking ---- */

typedef struct access_peer {
    uid_t uid; /* 0 may everything */
    gid_t gid;
    gid_t *groups; /* [n_groups], supplementary; owned */
    size_t n_groups;
} access_peer;
void access_peer_deinit(access_peer *peer);

/* The process that connected this Unix socket, as it was then. SHEAR_E_IO, SHEAR_E_NOMEM. */
int access_peer_from_socket(int socket, access_peer *peer, shear_error *err);
/* A user as the user database has it (asks it), say the owner of a dropped job file. A uid without
 * an entry has no groups but `gid`. */
int access_peer_from_user(uid_t uid, gid_t gid, access_peer *peer, shear_error *err);

/* The supplementary groups as text ("4 27 1000"; "" where there are none), to be kept with what the
 * peer asked for; *text is malloc'd. SHEAR_E_NOMEM. */
int access_peer_groups_text(const access_peer *peer, char **text, shear_error *err);
/* The peer again. SHEAR_E_INTERNAL where the text was not made by the above, SHEAR_E_NOMEM. */
int access_peer_from_text(uid_t uid, gid_t gid, const char *groups, access_peer *peer,
                          shear_error *err);

/* ---- lists of users and groups ---- */

typedef struct access_list access_list;

/* Asks the user database, once. A name may be a number. A name that the database does not know (of
 * a user who has left) stands for nobody, and is told below. SHEAR_E_IO: the database cannot be
 * asked; SHEAR_E_NOMEM. *list is NULL on error. */
int access_list_new(access_list **list, char *const *users, size_t n_users, char *const *groups,
                    size_t n_groups, shear_error *err);
void access_list_free(access_list *list); /* NULL is accepted */
/* What is to be said of the i-th name that was not known; NULL after the last. */
const char *access_list_unknown(const access_list *list, size_t i);
/* Is the peer one of the users, or does it have one of the groups? No, where the list is empty. */
bool access_list_has(const access_list *list, const access_peer *peer);

/* ---- files ---- */

typedef struct access_roots access_roots;

/* The data roots, absolute paths of directories. They need not be there: each is opened when it is
 * used, so that a disk may come and go, and one that is mounted later is found. SHEAR_E_SETTING,
 * SHEAR_E_NOMEM; *roots is NULL on error. None at all is allowed: then every path is outside. */
int access_roots_new(access_roots **roots, char *const *paths, size_t n, shear_error *err);
void access_roots_free(access_roots *roots); /* NULL is accepted */

/* Is this root there, for the service? SHEAR_OK or ACCESS_E_ROOT. */
int access_root_check(const char *path, shear_error *err);
/* Are they all? That of the first that is not. */
int access_roots_check(const access_roots *roots, shear_error *err);

/* Open the regular file at `path` for reading, for `peer`. The path is absolute, without "..", and
 * beneath a root, as that is configured or as it is without symbolic links; links beneath a root
 * are followed as long as they stay there (absolute ones are taken to leave it). Where the root's
 * name fits and it is not there: ACCESS_E_ROOT. *canonical (from malloc; free) is the file's path
 * without links. SHEAR_OK, enum access_code, SHEAR_E_IO,
 * SHEAR_E_NOMEM; on error *fd is -1 and *canonical NULL. What lies in directories that the peer may
 * not search is denied, whether it exists or not. */
int access_open(const access_roots *roots, const access_peer *peer, const char *path, int *fd,
                char **canonical, shear_error *err);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Find the user at the other end of a socket with its groups, or the groups of a user. */
#include "access/access.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

void access_peer_deinit(access_peer *peer) {
    free(peer->groups);
    *peer = (access_peer){(uid_t)-1, (gid_t)-1, NULL, 0};
}

static int fail(access_peer *peer, int error, const char *what, shear_error *err) {
    access_peer_deinit(peer);
    return shear_fail(err, error == ENOMEM ? SHEAR_E_NOMEM : SHEAR_E_IO, NULL,
                      "%s cannot be found out: %s", what, strerror(error));
}

/* Read the supplementary groups of the socket's peer. Return 0 or errno. */
static int read_groups(int socket, access_peer *peer) {
    socklen_t size = 64 * sizeof(gid_t);
    for (;;) {
        gid_t *groups = realloc(peer->groups, size);
        if (groups == NULL)
            return ENOMEM;
        peer->groups = groups;
        if (getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups, &size) == 0) {
            peer->n_groups = size / sizeof(gid_t);
            return 0;
        }
        if (errno != ERANGE) { /* ERANGE: size is now the size required */
            return errno;
        }
    }
}

int access_peer_from_socket(int socket, access_peer *peer, shear_error *err) {
    struct ucred who;
    socklen_t size = sizeof who;
    *peer = (access_peer){(uid_t)-1, (gid_t)-1, NULL, 0};
    if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0)
        return fail(peer, errno, "who is at the other end of the socket", err);
    /* Only a connected Unix socket has a peer. */
    if (size != sizeof who || who.uid == (uid_t)-1)
        return fail(peer, ENOTCONN, "who is at the other end of the socket", err);
    peer->uid = who.uid;
    peer->gid = who.gid;
    const int error = read_groups(socket, peer);
    return error == 0 ? SHEAR_OK : fail(peer, error, "the groups of the socket's peer", err);
}

static int groups_of(const char *user, access_peer *peer) {
    int n = 64;
    for (;;) {
        gid_t *groups = reallocarray(peer->groups, (size_t)n, sizeof *groups);
        if (groups == NULL)
            return ENOMEM;
        peer->groups = groups;
        const int capacity = n;
        if (getgrouplist(user, peer->gid, groups, &n) >= 0) {
            peer->n_groups = (size_t)n;
            return 0;
        }
        n = n > capacity ? n : 2 * capacity;
    }
}

int access_peer_from_user(uid_t uid, gid_t gid, access_peer *peer, shear_error *err) {
    char texts[16384];
    struct passwd entry;
    struct passwd *found = NULL;
    *peer = (access_peer){uid, gid, NULL, 0};
    int error = getpwuid_r(uid, &entry, texts, sizeof texts, &found);
    if (found == NULL && (error == 0 || error == ENOENT || error == ESRCH))
        return SHEAR_OK;
    if (error == 0) {
        peer->gid = entry.pw_gid;
        error = groups_of(entry.pw_name, peer);
    }
    return error == 0 ? SHEAR_OK : fail(peer, error, "the groups of a user", err);
}

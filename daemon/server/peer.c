/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/peer.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/socket.h>

/* The kernel says how much room it wants where there is too little. A peer's groups cannot change
 * after its connect, so the second call succeeds. */
static int read_groups(server_peer *peer, int fd) {
    socklen_t size = 0;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, NULL, &size) == 0) {
        return 0; /* none */
    }
    if (errno != ERANGE) {
        return -errno;
    }
    peer->groups = malloc(size);
    if (!peer->groups) {
        return -ENOMEM;
    }
    if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, peer->groups, &size) != 0) {
        return -errno;
    }
    peer->n_groups = size / sizeof *peer->groups;
    return 0;
}

int peer_init(server_peer *peer, int fd) {
    struct ucred c;
    socklen_t size = sizeof c;
    *peer = (server_peer){0};
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &c, &size) != 0) {
        return -errno;
    }
    peer->uid = c.uid;
    peer->gid = c.gid;
    peer->pid = c.pid;
    const int rc = read_groups(peer, fd);
    if (rc != 0) {
        peer_deinit(peer);
    }
    return rc;
}

void peer_deinit(server_peer *peer) {
    free(peer->groups);
    *peer = (server_peer){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who is at the other end of a Unix socket. */
#ifndef SERVER_PEER_H
#define SERVER_PEER_H

#include "server/server.h"

/* 0 or a negative errno; then there is nothing to free. */
int peer_init(server_peer *peer, int fd);
void peer_deinit(server_peer *peer); /* zeroed: fine */

#endif

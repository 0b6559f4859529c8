/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/accept.h: clients that wait are let in, or told why not. */
#ifndef SHEARD_SERVER_ACCEPT_H
#define SHEARD_SERVER_ACCEPT_H

#include "server/server.h"

/* Make the lines that refuse a client. False: out of memory. */
bool accept_init(server *s);
/* libuv's callback for a client that waits. */
void accept_on_connection(uv_stream_t *listener, int status);
/* Accept those that wait. */
void accept_waiting(server *s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/accept.h: accept waiting clients, or refuse them with the reason. */
#pragma once

#include "server/server.h"

/* Format the lines that refuse a client. Return false if out of memory. */
bool accept_init(server *s);
/* Accept the client that waits at `listener`; libuv's connection callback. */
void accept_on_connection(uv_stream_t *listener, int status);
/* Accept the clients that wait at all listeners. */
void accept_waiting(server *s);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection_loop.h: read a connection's input and process it, and close connections that
 * are idle or whose client does not read. Each call may close the connection. */
#pragma once

#include "server/connection.h"

/* Start reading. */
void connection_start(connection *c);
/* Do the next thing: one request, or one step of a request's deferred work. */
void connection_process(connection *c);
/* Write what is queued, as much as the socket takes. */
void connection_flush(connection *c);
/* Close the connection if it is idle, stalled or gone. */
void connection_tick(connection *c);

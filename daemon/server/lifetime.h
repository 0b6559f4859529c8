/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/lifetime.h: when the server's memory is free: libuv has it until all handles are closed.
 */
#ifndef SHEARD_SERVER_LIFETIME_H
#define SHEARD_SERVER_LIFETIME_H

#include "server/server.h"

/* Free a server without handles, and tell its owner that it is gone. */
void lifetime_free(server *s);
/* Close one of the server's own handles, once. */
void lifetime_close_handle(void *handle);
/* A handle of the server, or of a connection, has been closed. The last one frees the server. */
void lifetime_handle_closed(server *s);
/* Close the last handles where the server is closing and has no connection. */
void lifetime_end_if_empty(server *s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/lifetime.h: free the server once libuv has closed all of its handles. */
#pragma once

#include "server/server.h"

/* Free a server without open handles, and notify its owner. */
void lifetime_free(server *s);
/* Close one of the server's own handles; further calls do nothing. */
void lifetime_close_handle(void *handle);
/* Count a closed handle, of the server or of a connection. The last one frees the server. */
void lifetime_handle_closed(server *s);
/* Close the remaining handles if the server is closing and has no connection. */
void lifetime_end_if_empty(server *s);

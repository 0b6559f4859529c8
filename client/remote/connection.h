/* SPDX-License-Identifier: GPL-3.0-or-later */
/* connection.h: a connection to the service: requests and their replies (docs/protocol.md).
 *
 * Functions that return an enum connection_status write message and advice into *error (never NULL)
 * unless it is CONNECTION_OK. Every wait ends at its timeout, or when progress.h has caught a
 * signal. Nothing is printed here. */
#pragma once

#include "remote/connection_status.h"

#include "sheard/rpc.h"

#define CONNECTION_DEFAULT_SOCKET "/run/sheard/sheard.sock"

typedef struct connection connection;

/* Called for each notification that arrives during another wait. */
typedef void connection_listener(void *context, const sheard_message *notice);

/* Connect, send `hello` and check the version, all within `timeout_s`. *c is NULL on errors. */
enum connection_status connection_open(connection **c, const char *path, double timeout_s,
                                       sheard_rpc_error *error);
void connection_close(connection *c); /* NULL is accepted */

/* Return the reply to `hello`, owned by the connection. */
const sheard_msg_welcome *connection_welcome(const connection *c);

/* Set the listener for notifications; NULL: they are dropped. */
void connection_listen(connection *c, connection_listener *listener, void *context);

/* Send a request and wait for the reply. `params` is as in sheard_request_line. *reply (to be
 * released by sheard_reply_deinit) and *text (the result as received, one line, to be freed) may
 * each be NULL. After any status other than OK and REFUSED the connection must be closed. */
enum connection_status connection_call(connection *c, int method, const sheard_params *params,
                                       double timeout_s, sheard_reply *reply, char **text,
                                       sheard_rpc_error *error);

/* Return the environment variable SHEARD_SOCKET, or "/run/sheard/sheard.sock" if it is not set. */
const char *connection_default_path(void);

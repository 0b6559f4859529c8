/* SPDX-License-Identifier: GPL-3.0-or-later */
/* connection.h: a conversation with the service (docs/protocol.md).
 *
 * Functions that return an enum connection_status leave message and advice in *error (never NULL)
 * if it is not CONNECTION_OK. Every wait ends: at its timeout, or when progress.h has caught a
 * signal. Nothing is printed here. */
#ifndef CLIENT_REMOTE_CONNECTION_H
#define CLIENT_REMOTE_CONNECTION_H

#include "remote/connection_status.h"

#include "sheard/rpc.h"

#define CONNECTION_DEFAULT_SOCKET "/run/sheard/sheard.sock"

typedef struct connection connection;

/* Called for each notification that comes while waiting for something else. */
typedef void connection_listener(void *context, const sheard_message *notice);

/* Connect, say hello and check the version, all within `timeout_s`. *c is NULL on errors. */
enum connection_status connection_open(connection **c, const char *path, double timeout_s,
                                       sheard_rpc_error *error);
void connection_close(connection *c); /* NULL is accepted */

/* What the service said to hello. */
const sheard_msg_welcome *connection_welcome(const connection *c);

void connection_listen(connection *c, connection_listener *listener, void *context);

/* Ask and wait for the answer. `params` as in sheard_request_line. Any of *reply (to be given to
 * sheard_reply_deinit) and *text (the result as it came, one line, to be freed) may be NULL. After
 * anything but OK and REFUSED the connection is of no more use. */
enum connection_status connection_call(connection *c, int method, const sheard_params *params,
                                       double timeout_s, sheard_reply *reply, char **text,
                                       sheard_rpc_error *error);

/* "/run/sheard/sheard.sock", or what the environment variable SHEARD_SOCKET says. */
const char *connection_default_path(void);

#endif

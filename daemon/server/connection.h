/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection.h: one client: its state, its output, and its end. connection_loop.h declares
 * its input and processing. */
#pragma once

#include "server/open_requests.h"
#include "server/out_queue.h"
#include "server/server.h"
#include "server/subscriptions.h"
#include "sheard/frame.h"

#include <sys/queue.h>

typedef struct connection connection;
struct server_user;
typedef TAILQ_HEAD(connection_list, connection) connection_list;

struct connection {
    uv_pipe_t pipe;
    uv_write_t write;
    server *server;
    uint64_t id;
    access_peer peer;
    struct server_user *user;
    bool is_admin;
    uint64_t used_ns; /* processor time charged to it: users.h */
    size_t place;     /* from 1 on, in its user's heap of ready connections; 0: not in it */
    bool in_deferred; /* in its user's list of connections with deferred work */

    sheard_frame frame;
    const char *input; /* [n_input] bytes within `kept`: read, but not processed yet */
    size_t n_input;
    char *kept;

    open_requests open;
    subscriptions subscriptions;
    out_queue out;
    size_t writing;   /* bytes of `out` handed to libuv, because the socket's buffer is full */
    uint64_t lost;    /* notifications left out since the last `lost` */
    size_t unwritten; /* bytes that libuv held at the last tick */

    uint64_t active_ms;   /* time of the last line or reply */
    uint64_t partial_ms;  /* time when an incomplete line began; 0: there is none */
    uint64_t progress_ms; /* time when the client last took some of the queued bytes */

    bool reading;
    bool held_up;   /* the limits allow no further line now */
    bool ended;     /* the client has shut down its writing side */
    bool finishing; /* nothing more is processed; closed when everything is written */
    bool aborted;   /* to be closed in the next slice, whatever is queued */
    bool closed;
    bool unflushed, subscribed; /* whether it is in the server's lists of these */
    TAILQ_ENTRY(connection) unflushed_link, subscriber_link, deferred_link;
};

/* Close the connection; further calls do nothing. The memory is freed when libuv has closed the
 * handle. */
void connection_close(connection *c);
/* Free the connection; the handle's close callback. */
void connection_on_closed(uv_handle_t *handle);
/* Process no further input, and close the connection when everything is written. */
void connection_finish(connection *c);
/* Close the connection in the next slice, whatever is queued. */
void connection_abort(connection *c);

/* Queue a line and take over the caller's reference. NULL means that there was no memory for the
 * line: the connection is then aborted. */
void connection_send(connection *c, out_line *line);
/* Make a notification, with one reference. Return NULL if out of memory. */
out_line *connection_notice(enum sheard_notice notice, const sheard_notice_params *params);
/* Queue a notification, or count it as lost. The reference stays the caller's. */
void connection_notify(connection *c, out_line *line);
/* Queue a notification of how many were lost, if the queue is short enough. */
void connection_tell_lost(connection *c);
/* Queue an error reply; `id` is NULL if the request's is unknown. */
void connection_send_error(connection *c, const sheard_rpc_id *id, const sheard_rpc_error *error);
/* Write what is queued, as much as the socket takes. */
void connection_write(connection *c);

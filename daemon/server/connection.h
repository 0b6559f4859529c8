/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection.h: one client: what is sent to it, and how it ends. connection_loop.h has the
 * rest. */
#ifndef SHEARD_SERVER_CONNECTION_H
#define SHEARD_SERVER_CONNECTION_H

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
    uint64_t used_ns; /* see users.h */
    size_t place;     /* in its user's heap of those that are ready; 0: none */
    bool in_deferred; /* in the user's list of those whose work waits */

    sheard_frame frame;
    const char *input; /* [n_input] of `kept`: read and not processed yet */
    size_t n_input;
    char *kept;

    open_requests open;
    subscriptions subscriptions;
    out_queue out;
    size_t writing;   /* bytes of `out` that libuv has, because the socket's buffer is full */
    uint64_t lost;    /* notifications left out */
    size_t unwritten; /* bytes that libuv had at the last tick */

    uint64_t active_ms;   /* the last line, or reply */
    uint64_t partial_ms;  /* when a line began that has not ended; 0: there is none */
    uint64_t progress_ms; /* the last time that the client took something of what is queued */

    bool reading;
    bool held_up;   /* nothing of it is processed for now */
    bool ended;     /* the client sends no more */
    bool finishing; /* nothing is processed any more; closed when all is written */
    bool aborted;   /* to be closed in the next slice, whatever is queued */
    bool closed;
    bool unflushed, subscribed; /* in the server's lists */
    TAILQ_ENTRY(connection) unflushed_link, subscriber_link, deferred_link;
};

/* Both may come again. The memory goes when libuv has closed the handle. */
void connection_close(connection *c);
/* The handle's close callback. */
void connection_on_closed(uv_handle_t *handle);
/* Process nothing more of it, and close it when everything is written. */
void connection_finish(connection *c);
/* Close it in the next slice. */
void connection_abort(connection *c);

/* Queue a line (NULL: there was no memory for it; the connection is given up). Takes the caller's
 * reference over. */
void connection_send(connection *c, out_line *line);
/* Queue a notification, or count it as lost. The reference stays the caller's. */
void connection_notify(connection *c, out_line *line);
/* Tell how many notifications were lost, once there is room for that. */
void connection_tell_lost(connection *c);
/* `id` is NULL where the request's is not known. */
void connection_send_error(connection *c, const sheard_rpc_id *id, const sheard_rpc_error *error);
/* Write what is queued, as much as the socket takes. */
void connection_write(connection *c);

#endif

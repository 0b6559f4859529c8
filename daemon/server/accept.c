/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/accept.h"

#include "server/connection_loop.h"
#include "server/internal.h"

#include <stdlib.h>

bool accept_init(server *s) {
    static const char *const texts[N_REFUSALS] = {
        "the service has as many connections as it may have ([limits] connections)",
        "you have as many connections as a user may have ([limits] user_connections)"};
    const sheard_rpc_id none = {.type = SHEARD_ID_NULL};
    for (int i = 0; i < N_REFUSALS; i++) {
        sheard_rpc_error error;
        sheard_rpc_fail(&error, SHEARD_RPC_TOO_MANY_CONNECTIONS, NULL, "%s", texts[i]);
        if (sheard_error_line(&s->refusals[i], &s->refusal_bytes[i], &none, &error) !=
            SHEARD_RPC_OK) {
            return false;
        }
    }
    return true;
}

static bool begin(connection *c) {
    const server_handlers *h = &c->server->handlers;
    int fd = -1;
    if (uv_fileno((const uv_handle_t *)&c->pipe, &fd) != 0 ||
        access_peer_from_socket(fd, &c->peer, NULL) != SHEAR_OK) {
        return false;
    }
    c->user = users_join(&c->server->scheduler.users, c->peer.uid, c->server->scheduler.clock_ns);
    c->is_admin = h->is_admin != NULL && h->is_admin(h->context, &c->peer);
    return c->user != NULL;
}

/* Return the limit that forbids the connection, or N_REFUSALS if none does. */
static enum refusal find_refusal(const connection *c) {
    const server *s = c->server;
    const server_limits *l = &s->limits;
    const size_t reserved =
        c->is_admin || s->handlers.is_admin == NULL ? 0 : l->reserved_connections;
    return s->statistics.connections + reserved >= l->connections        ? REFUSAL_ALL_CONNECTIONS
           : !c->is_admin && c->user->connections >= l->user_connections ? REFUSAL_USER_CONNECTIONS
                                                                         : N_REFUSALS;
}

/* Send the line that gives the reason. The socket's buffer is empty, so the line is written at once
 * or not at all. */
static void refuse(connection *c, enum refusal why) {
    server *s = c->server;
    uv_buf_t buf = {.base = s->refusals[why], .len = s->refusal_bytes[why]};
    s->statistics.refused++;
    if (uv_try_write((uv_stream_t *)&c->pipe, &buf, 1) > 0)
        s->statistics.errors[SHEARD_RPC_TOO_MANY_CONNECTIONS]++;
}

static bool let_in(connection *c) {
    if (!begin(c))
        return false;
    const enum refusal why = find_refusal(c);
    if (why != N_REFUSALS) {
        refuse(c, why);
        return false;
    }
    return connection_table_enter(c->server, c);
}

/* Accept one client. Return false if out of memory: the client still waits. */
static bool accept_client(server *s, uv_stream_t *listener) {
    connection *c = calloc(1, sizeof *c);
    if (c == NULL)
        return false;
    c->server = s;
    c->active_ms = uv_now(s->loop);
    sheard_frame_init(&c->frame, s->limits.line_bytes);
    open_requests_init(&c->open);
    uv_pipe_init(s->loop, &c->pipe, 0);
    c->pipe.data = c;
    s->handles++;
    if (uv_accept(listener, (uv_stream_t *)&c->pipe) == 0 && let_in(c)) {
        s->statistics.accepted++;
        connection_start(c);
    } else {
        c->closed = true;
        uv_close((uv_handle_t *)&c->pipe, connection_on_closed);
    }
    return true;
}

void accept_on_connection(uv_stream_t *listener, int status) {
    server *s = listener->data;
    /* An error (too many descriptors, say) ends the accept of this client only. */
    if (status == 0 && scheduler_may_accept(s) && !accept_client(s, listener))
        s->starved = true;
}

/* libuv keeps the client that was not accepted, and announces no other before that. */
void accept_waiting(server *s) {
    for (size_t i = 0; s->accepting && i < s->n_listeners; i++)
        accept_on_connection((uv_stream_t *)&s->listeners[i], 0);
}

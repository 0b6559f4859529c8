/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Send replies, and manage the deferred work of requests. */
#include "server/internal.h"

#include <stdlib.h>

/* Return the handle's unanswered request, and its connection, or NULL if there is none. */
static open_request *find(const server *s, server_handle handle, connection **c) {
    *c = connection_table_find(s, handle.connection);
    open_request *r = *c != NULL ? open_requests_find(&(*c)->open, handle.request) : NULL;
    return r != NULL && !r->answered ? r : NULL;
}

static void answered(connection *c, open_request *r) {
    server *s = c->server;
    if (r == s->in_step) {
        r->answered = true; /* removed when its step has ended */
        s->in_step = NULL;
    } else {
        if (r->awake)
            scheduler_end_work(s, c);
        open_requests_remove(&c->open, r);
    }
    c->active_ms = uv_now(c->server->loop);
    scheduler_add(s, c); /* the next line may be allowed now */
}

void server_reply_error(server *s, server_handle to, const sheard_rpc_error *error) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r != NULL) {
        connection_send_error(c, &r->id, error);
        answered(c, r);
    }
}

void server_reply_line(server *s, server_handle to, char *line, size_t n) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r == NULL) {
        free(line);
    } else if (line != NULL) {
        connection_send(c, out_line_new(line, n));
        answered(c, r);
    } else {
        sheard_rpc_error error;
        sheard_rpc_fail(&error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory for the reply");
        server_reply_error(s, to, &error);
    }
}

void server_reply(server *s, server_handle to, const sheard_reply *reply) {
    connection *c;
    const open_request *r = find(s, to, &c);
    sheard_rpc_error error;
    char *line;
    size_t n;
    if (r == NULL)
        return;
    if (sheard_reply_line(&line, &n, &r->id, r->method, reply, &error) == SHEARD_RPC_OK) {
        server_reply_line(s, to, line, n);
    } else {
        server_reply_error(s, to, &error);
    }
}

/* ---- deferred work ---- */

bool server_defer(server *s, server_handle to, const server_work *work) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r == NULL) {
        work->drop(work->context);
        return false;
    }
    r->work = *work;
    open_requests_wake(&c->open, r);
    scheduler_add(s, c);
    return true;
}

void server_wake(server *s, server_handle to) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r != NULL && r->work.step != NULL) {
        open_requests_wake(&c->open, r);
        scheduler_add(s, c);
    }
}

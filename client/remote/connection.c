/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/connection.h"

#include "base/cleanup.h"
#include "base/clock.h"

#include "remote/socket_io.h"
#include "shear/version.h"
#include "sheard/frame.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { INPUT_SIZE = 65536 };

typedef struct connection {
    int fd;
    int64_t last_id;
    sheard_frame frame;
    const char *at; /* the unread part of `input` */
    size_t left;
    connection_listener *listener;
    void *context;
    sheard_reply welcome; /* the reply to `hello` */
    char input[INPUT_SIZE];
} connection;

const char *connection_default_path(void) {
    const char *path = getenv("SHEARD_SOCKET");
    return path != NULL && *path != '\0' ? path : CONNECTION_DEFAULT_SOCKET;
}

const sheard_msg_welcome *connection_welcome(const connection *c) {
    return &c->welcome.hello;
}

void connection_listen(connection *c, connection_listener *listener, void *context) {
    c->listener = listener;
    c->context = context;
}

void connection_close(connection *c) {
    if (c == NULL)
        return;
    if (c->fd >= 0)
        close(c->fd);
    sheard_reply_deinit(&c->welcome, SHEARD_METHOD_HELLO);
    sheard_frame_deinit(&c->frame);
    free(c);
}

CLEANUP_DEFINE(connection, connection_close)

/* Map an error of the protocol layer: out of memory is local, all others are the peer's. */
static enum connection_status bad_message(const sheard_rpc_error *error) {
    return error->code == SHEARD_RPC_OUT_OF_MEMORY ? CONNECTION_FAILED : CONNECTION_MISMATCH;
}

static enum connection_status bad_line(enum sheard_frame_event event, sheard_rpc_error *error) {
    switch (event) {
    case SHEARD_FRAME_NOMEM:
        return connection_fail(error, CONNECTION_FAILED, NULL,
                               "out of memory for the service's answer");
    case SHEARD_FRAME_NUL:
        return connection_fail(error, CONNECTION_MISMATCH,
                               "use a client and a service of one release",
                               "the service's answer is not text");
    default:
        return connection_fail(error, CONNECTION_MISMATCH, "ask for less with --limit",
                               "the service's answer is longer than %zu bytes",
                               sheard_rpc_reply_limits.line);
    }
}

/* Receive the next message of any kind. */
static enum connection_status receive(connection *c, double deadline, sheard_message *m,
                                      sheard_rpc_error *error) {
    for (;;) {
        const char *line = NULL;
        size_t n = 0;
        const enum sheard_frame_event event =
            sheard_frame_next(&c->frame, &c->at, &c->left, &line, &n);
        if (event == SHEARD_FRAME_LINE) {
            return sheard_message_parse(m, line, n, error) != 0 ? bad_message(error)
                                                                : CONNECTION_OK;
        }
        if (event != SHEARD_FRAME_MORE)
            return bad_line(event, error);
        c->at = c->input;
        TRY(socket_io_receive(c->fd, c->input, sizeof c->input, &c->left, deadline, error));
    }
}

/* Receive the reply to request `id`; pass notifications to the listener. An error without an id
 * concerns the connection (too many connections, the service stops), and ends the wait, too. */
static enum connection_status receive_answer(connection *c, int64_t id, double deadline,
                                             sheard_message *m, sheard_rpc_error *error) {
    for (;;) {
        TRY(receive(c, deadline, m, error));
        if (m->kind == SHEARD_MESSAGE_NOTICE) {
            if (c->listener != NULL && m->notice >= 0)
                c->listener(c->context, m);
        } else if ((m->id.type == SHEARD_ID_INTEGER && m->id.integer == id) ||
                   (m->kind == SHEARD_MESSAGE_ERROR && m->id.type == SHEARD_ID_NULL)) {
            return CONNECTION_OK;
        } else {
            sheard_message_deinit(m);
            return connection_fail(error, CONNECTION_MISMATCH,
                                   "use a client and a service of one release",
                                   "the service sent a reply to no request");
        }
        sheard_message_deinit(m);
    }
}

static enum connection_status read_answer(const sheard_message *m, int method, sheard_reply *reply,
                                          char **text, sheard_rpc_error *error) {
    if (m->kind == SHEARD_MESSAGE_ERROR) {
        *error = m->error;
        return CONNECTION_REFUSED;
    }
    if (reply != NULL && sheard_message_reply(m, method, reply, error) != 0)
        return bad_message(error);
    if (text != NULL && sheard_message_text(m, text, error) != 0) {
        if (reply != NULL)
            sheard_reply_deinit(reply, method);
        return bad_message(error);
    }
    return CONNECTION_OK;
}

static enum connection_status send_request(connection *c, int method, const sheard_params *params,
                                           double deadline, sheard_rpc_error *error) {
    CLEANUP(release_free) char *line = NULL;
    size_t n = 0;
    const sheard_rpc_id id = {.type = SHEARD_ID_INTEGER, .integer = ++c->last_id};
    if (sheard_request_line(&line, &n, &id, method, params, error) != 0) {
        /* The request is checked here with the service's own rules and messages. */
        return error->code == SHEARD_RPC_OUT_OF_MEMORY ? CONNECTION_FAILED : CONNECTION_REFUSED;
    }
    return socket_io_send(c->fd, line, n, deadline, error);
}

enum connection_status connection_call(connection *c, int method, const sheard_params *params,
                                       double timeout_s, sheard_reply *reply, char **text,
                                       sheard_rpc_error *error) {
    const double deadline = clock_s(CLOCK_MONOTONIC) + timeout_s;
    sheard_message m = {.notice = -1};
    TRY(send_request(c, method, params, deadline, error));
    TRY(receive_answer(c, c->last_id, deadline, &m, error));
    const enum connection_status status = read_answer(&m, method, reply, text, error);
    sheard_message_deinit(&m);
    return status;
}

static enum connection_status greet(connection *c, const char *path, double timeout_s,
                                    sheard_rpc_error *error) {
    sheard_params params;
    sheard_params_init(&params, SHEARD_METHOD_HELLO);
    params.hello = (sheard_msg_hello){.oldest = SHEARD_PROTOCOL_OLDEST,
                                      .newest = SHEARD_PROTOCOL_VERSION,
                                      .client = "shearctl " SHEAR_VERSION_STRING};
    const enum connection_status status =
        connection_call(c, SHEARD_METHOD_HELLO, &params, timeout_s, &c->welcome, NULL, error);
    if (status == CONNECTION_MISMATCH) {
        char why[300];
        snprintf(why, sizeof why, "%.290s", error->message);
        return connection_fail(error, status, "is this the socket of sheard?",
                               "what listens at %s is not a service that this client knows: %s",
                               path, why);
    }
    if (status == CONNECTION_REFUSED && error->code == SHEARD_RPC_UNSUPPORTED_VERSION)
        return CONNECTION_MISMATCH;
    const int64_t version = c->welcome.hello.protocol;
    if (status == CONNECTION_OK &&
        (version < SHEARD_PROTOCOL_OLDEST || version > SHEARD_PROTOCOL_VERSION)) {
        return connection_fail(
            error, CONNECTION_MISMATCH, "use a client and a service of the same release",
            "the service speaks version %" PRId64 " of the protocol, this client %d to %d", version,
            SHEARD_PROTOCOL_OLDEST, SHEARD_PROTOCOL_VERSION);
    }
    return status;
}

enum connection_status connection_open(connection **out, const char *path, double timeout_s,
                                       sheard_rpc_error *error) {
    const double deadline = clock_s(CLOCK_MONOTONIC) + timeout_s;
    *out = NULL;
    CLEANUP(connection_release) connection *c = calloc(1, sizeof *c);
    if (c == NULL)
        return connection_fail(error, CONNECTION_FAILED, NULL, "out of memory");
    sheard_frame_init(&c->frame, sheard_rpc_reply_limits.line);
    TRY(socket_io_connect(path, deadline, &c->fd, error));
    TRY(greet(c, path, deadline - clock_s(CLOCK_MONOTONIC), error));
    *out = CLEANUP_TAKE(c);
    return CONNECTION_OK;
}

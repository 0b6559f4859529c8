/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "connection.h"

#include "dial.h"
#include "shear/version.h"
#include "sheard/frame.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { INPUT_SIZE = 65536 };

struct connection {
    int fd;
    int64_t last_id;
    shear_frame frame;
    const char *at; /* what is left of `input` for the frame */
    size_t left;
    connection_listener *listener;
    void *context;
    shear_reply welcome; /* of hello */
    char input[INPUT_SIZE];
};

const char *connection_default_path(void) {
    const char *path = getenv("SHEARD_SOCKET");
    return path && *path ? path : CONNECTION_DEFAULT_SOCKET;
}

const shear_msg_welcome *connection_welcome(const struct connection *c) {
    return &c->welcome.hello;
}

void connection_listen(struct connection *c, connection_listener *listener, void *context) {
    c->listener = listener;
    c->context = context;
}

void connection_close(struct connection *c) {
    if (!c) {
        return;
    }
    if (c->fd >= 0) {
        close(c->fd);
    }
    shear_reply_deinit(&c->welcome, SHEAR_METHOD_HELLO);
    shear_frame_deinit(&c->frame);
    free(c);
}

/* An error of the protocol's layer: no memory is ours, the rest is what the peer sent. */
static int bad_message(const shear_rpc_error *error) {
    return error->code == SHEAR_RPC_OUT_OF_MEMORY ? CONNECTION_FAILED : CONNECTION_MISMATCH;
}

static int bad_line(int event, shear_rpc_error *error) {
    switch (event) {
    case SHEAR_FRAME_NOMEM:
        return dial_fail(error, CONNECTION_FAILED, NULL, "out of memory for the service's answer");
    case SHEAR_FRAME_NUL:
        return dial_fail(error, CONNECTION_MISMATCH, "use a client and a service of one release",
                         "the service's answer is not text");
    default:
        return dial_fail(error, CONNECTION_MISMATCH, "ask for less with --limit",
                         "the service's answer is longer than %zu bytes",
                         shear_rpc_reply_limits.line);
    }
}

/* The next message of any kind. */
static int receive(struct connection *c, double deadline, shear_message *m,
                   shear_rpc_error *error) {
    for (;;) {
        const char *line = NULL;
        size_t n = 0;
        const int event = shear_frame_next(&c->frame, &c->at, &c->left, &line, &n);
        if (event == SHEAR_FRAME_LINE) {
            return shear_message_parse(m, line, n, error) ? bad_message(error) : CONNECTION_OK;
        }
        if (event != SHEAR_FRAME_MORE) {
            return bad_line(event, error);
        }
        c->at = c->input;
        const int status =
            dial_receive(c->fd, c->input, sizeof c->input, &c->left, deadline, error);
        if (status != CONNECTION_OK) {
            return status;
        }
    }
}

/* The answer to request `id`; notifications on the way go to the listener. An error without an id
 * is about the connection (too many of them, the service stops) and is an answer, too. */
static int receive_answer(struct connection *c, int64_t id, double deadline, shear_message *m,
                          shear_rpc_error *error) {
    for (;;) {
        const int status = receive(c, deadline, m, error);
        if (status != CONNECTION_OK) {
            return status;
        }
        if (m->kind == SHEAR_MESSAGE_NOTICE) {
            if (c->listener && m->notice >= 0) {
                c->listener(c->context, m);
            }
        } else if ((m->id.type == SHEAR_ID_INTEGER && m->id.integer == id) ||
                   (m->kind == SHEAR_MESSAGE_ERROR && m->id.type == SHEAR_ID_NULL)) {
            return CONNECTION_OK;
        } else {
            shear_message_deinit(m);
            return dial_fail(error, CONNECTION_MISMATCH,
                             "use a client and a service of one release",
                             "the service answers what was not asked");
        }
        shear_message_deinit(m);
    }
}

static int take_answer(const shear_message *m, int method, shear_reply *reply, char **text,
                       shear_rpc_error *error) {
    if (m->kind == SHEAR_MESSAGE_ERROR) {
        *error = m->error;
        return CONNECTION_REFUSED;
    }
    if (reply && shear_message_reply(m, method, reply, error)) {
        return bad_message(error);
    }
    if (text && shear_message_text(m, text, error)) {
        if (reply) {
            shear_reply_deinit(reply, method);
        }
        return bad_message(error);
    }
    return CONNECTION_OK;
}

static int send_request(struct connection *c, int method, const shear_params *params,
                        double deadline, shear_rpc_error *error) {
    char *line = NULL;
    size_t n = 0;
    const shear_rpc_id id = {.type = SHEAR_ID_INTEGER, .integer = ++c->last_id};
    if (shear_request_line(&line, &n, &id, method, params, error)) {
        /* What the service would refuse is refused here, in the same words. */
        return error->code == SHEAR_RPC_OUT_OF_MEMORY ? CONNECTION_FAILED : CONNECTION_REFUSED;
    }
    const int status = dial_send(c->fd, line, n, deadline, error);
    free(line);
    return status;
}

int connection_call(struct connection *c, int method, const shear_params *params, double timeout_s,
                    shear_reply *reply, char **text, shear_rpc_error *error) {
    const double deadline = dial_now() + timeout_s;
    shear_message m = {.notice = -1};
    int status = send_request(c, method, params, deadline, error);
    if (status != CONNECTION_OK) {
        return status;
    }
    status = receive_answer(c, c->last_id, deadline, &m, error);
    if (status == CONNECTION_OK) {
        status = take_answer(&m, method, reply, text, error);
        shear_message_deinit(&m);
    }
    return status;
}

static int greet(struct connection *c, const char *path, double timeout_s, shear_rpc_error *error) {
    shear_params params;
    shear_params_init(&params, SHEAR_METHOD_HELLO);
    params.hello = (shear_msg_hello){.oldest = SHEAR_PROTOCOL_OLDEST,
                                     .newest = SHEAR_PROTOCOL_VERSION,
                                     .client = "shearctl " SHEAR_VERSION_STRING};
    const int status =
        connection_call(c, SHEAR_METHOD_HELLO, &params, timeout_s, &c->welcome, NULL, error);
    if (status == CONNECTION_MISMATCH) {
        char why[300];
        snprintf(why, sizeof why, "%.290s", error->message);
        return dial_fail(error, status, "is this the socket of sheard?",
                         "what listens at %s is not a service that this client knows: %s", path,
                         why);
    }
    if (status == CONNECTION_REFUSED && error->code == SHEAR_RPC_UNSUPPORTED_VERSION) {
        return CONNECTION_MISMATCH;
    }
    const int64_t version = c->welcome.hello.protocol;
    if (status == CONNECTION_OK &&
        (version < SHEAR_PROTOCOL_OLDEST || version > SHEAR_PROTOCOL_VERSION)) {
        return dial_fail(error, CONNECTION_MISMATCH,
                         "use a client and a service of the same release",
                         "the service speaks version %" PRId64 " of the protocol, this client %d "
                         "to %d",
                         version, SHEAR_PROTOCOL_OLDEST, SHEAR_PROTOCOL_VERSION);
    }
    return status;
}

int connection_open(struct connection **out, const char *path, double timeout_s,
                    shear_rpc_error *error) {
    const double deadline = dial_now() + timeout_s;
    *out = NULL;
    struct connection *c = calloc(1, sizeof *c);
    if (!c) {
        return dial_fail(error, CONNECTION_FAILED, NULL, "out of memory");
    }
    shear_frame_init(&c->frame, shear_rpc_reply_limits.line);
    int status = dial_connect(path, deadline, &c->fd, error);
    if (status == CONNECTION_OK) {
        status = greet(c, path, deadline - dial_now(), error);
    }
    if (status != CONNECTION_OK) {
        connection_close(c);
        return status;
    }
    *out = c;
    return CONNECTION_OK;
}

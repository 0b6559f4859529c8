/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/dispatch.h"

#include "base/cleanup.h"
#include "server/internal.h"

/* No line is taken while output is unwritten, while deferred work is runnable, or while too many
 * requests are unanswered. */
bool dispatch_is_allowed(const connection *c) {
    const server *s = c->server;
    const size_t in_flight = scheduler_is_crowded(s, c->user) ? 1 : s->limits.in_flight;
    return !c->finishing && !c->aborted && !c->closed && c->writing == 0 &&
           TAILQ_EMPTY(&c->open.awake) && c->open.n - c->open.n_long < in_flight;
}

static int admit(connection *c, const sheard_request *request, uint64_t *number,
                 sheard_rpc_error *error) {
    const size_t limit = c->server->limits.in_flight;
    if (open_request_is_long(request) && c->open.n_long >= limit) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_MANY_REQUESTS,
                               "wait for several jobs in one request, or for fewer at a time",
                               "this connection has %zu requests that wait for jobs", limit);
    }
    *number = open_requests_add(&c->open, request);
    return *number != 0 ? SHEARD_RPC_OK
                        : sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                                          "out of memory for a request");
}

static int dispatch_request(connection *c, sheard_request *request, const char *line, size_t n,
                            sheard_rpc_error *error) {
    server *s = c->server;
    uint64_t number = 0;
    TRY(sheard_request_parse(request, line, n, s->has_defaults ? &s->defaults : NULL, error));
    s->statistics.requests[request->method]++;
    TRY(admit(c, request, &number, error));
    const server_request given = {.handle = {c->id, number}, .peer = &c->peer, .request = request};
    s->handlers.request(s->handlers.context, &given);
    return SHEARD_RPC_OK;
}

static void handle_line(connection *c, const char *line, size_t n) {
    sheard_request request;
    sheard_rpc_error error;
    if (dispatch_request(c, &request, line, n, &error) != SHEARD_RPC_OK)
        connection_send_error(c, &request.id, &error);
    sheard_request_deinit(&request);
}

/* Answer what is no line. */
static void refuse(connection *c, enum sheard_frame_event event) {
    static const struct {
        int code;
        const char *message;
    } faults[] = {
        [SHEARD_FRAME_NUL] = {SHEARD_RPC_NUL_BYTE, "there is a NUL byte in the line"},
        [SHEARD_FRAME_TOO_LONG] = {SHEARD_RPC_LINE_TOO_LONG,
                                   "the line is too long; the connection ends"},
        [SHEARD_FRAME_NOMEM] = {SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a line"},
    };
    sheard_rpc_error error;
    sheard_rpc_fail(&error, faults[event].code, NULL, "%s", faults[event].message);
    connection_send_error(c, NULL, &error);
    if (event == SHEARD_FRAME_TOO_LONG)
        connection_finish(c);
}

void dispatch_line(connection *c) {
    server *s = c->server;
    const char *line;
    size_t n;
    const enum sheard_frame_event event =
        (enum sheard_frame_event)sheard_frame_next(&c->frame, &c->input, &c->n_input, &line, &n);
    if (event != SHEARD_FRAME_MORE) {
        s->statistics.lines++;
        c->active_ms = uv_now(s->loop);
        c->partial_ms = 0;
        if (event == SHEARD_FRAME_LINE) {
            handle_line(c, line, n);
        } else {
            refuse(c, event);
        }
    }
    if (sheard_frame_pending(&c->frame) == 0 && !c->frame.skipping) {
        c->partial_ms = 0;
    } else if (c->partial_ms == 0) {
        c->partial_ms = uv_now(s->loop);
    }
}

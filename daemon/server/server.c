/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/server.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "server/accept.h"
#include "server/connection_loop.h"
#include "server/internal.h"
#include "server/lifetime.h"

#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

enum { BACKLOG = 4096, MAX_TICK_MS = 1000 };

/* ---- limits ---- */

void server_limits_init(server_limits *limits) {
    *limits = (server_limits){.line_bytes = sheard_rpc_request_limits.line,
                              .connections = 2048,
                              .reserved_connections = 16,
                              .in_flight = 64,
                              .subscriptions = 1024,
                              .queue_bytes = (size_t)32 << 20,
                              .unsent_bytes = (size_t)64 << 20,
                              .slice_us = 3000,
                              .idle_timeout_ms = 600000,
                              .stall_timeout_ms = 60000,
                              .crowded_ms = 5000};
}

static size_t at_most(size_t n, size_t most) {
    return n < most ? n : most;
}

/* Return the limits with the bounds that always hold. */
static server_limits within_bounds(server_limits l) {
    l.line_bytes = at_most(l.line_bytes, sheard_rpc_request_limits.line);
    l.reserved_connections = at_most(l.reserved_connections, l.connections / 4);
    if (l.user_connections == 0)
        l.user_connections = l.connections / 4;
    l.user_connections += l.user_connections == 0; /* a quarter of very few is still one */
    return l;
}

/* ---- timer ---- */

static void on_tick(uv_timer_t *timer) {
    server *s = timer->data;
    connection_table_each(s, connection_tick);
    if (s->starved) {
        s->starved = false;
        accept_waiting(s);
    }
}

/* Start the tick: four times per shortest timeout, and at least once a second. */
static void start_tick(server *s) {
    int64_t ms = MAX_TICK_MS;
    const int64_t times[] = {s->limits.idle_timeout_ms, s->limits.stall_timeout_ms,
                             s->limits.crowded_ms};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        if (times[i] > 0 && times[i] / 4 < ms)
            ms = times[i] / 4 + 1;
    }
    uv_timer_start(&s->tick, on_tick, (uint64_t)ms, (uint64_t)ms);
}

/* ---- settings ---- */

static void schedule(connection *c) {
    scheduler_add(c->server, c);
}

void server_set_limits(server *s, const server_limits *limits) {
    s->limits = within_bounds(*limits);
    if (!s->closing)
        start_tick(s);
    connection_table_each(s, schedule); /* the new limits may allow more lines */
}

void server_set_defaults(server *s, const shear_settings *defaults) {
    s->has_defaults = defaults != NULL;
    if (defaults != NULL)
        s->defaults = *defaults;
}

void server_get_statistics(const server *s, server_statistics *statistics) {
    *statistics = s->statistics;
    statistics->unsent_bytes += s->notice_bytes;
}

/* ---- listening ---- */

static int listen_on(server *s, int fd, shear_error *err) {
    uv_pipe_t *listener = &s->listeners[s->n_listeners];
    uv_pipe_init(s->loop, listener, 0);
    listener->data = s;
    s->n_listeners++;
    s->handles++;
    int rc = uv_pipe_open(listener, fd);
    if (rc != 0)
        close(fd);
    rc = rc != 0 ? rc : uv_listen((uv_stream_t *)listener, BACKLOG, accept_on_connection);
    return rc == 0 ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_IO, NULL, "descriptor %d: cannot listen: %s", fd,
                                uv_strerror(rc));
}

static void close_fds(const int *fds, size_t n) {
    for (size_t i = 0; i < n; i++)
        close(fds[i]);
}

static int listen_on_all(server *s, const int *fds, size_t n, shear_error *err) {
    if (n > SERVER_MAX_LISTENERS) {
        close_fds(fds, n);
        return shear_fail(err, SHEAR_E_SETTING, "give fewer ListenStream= in sheard.socket",
                          "%zu sockets to listen on; at most %d are possible", n,
                          (int)SERVER_MAX_LISTENERS);
    }
    for (size_t i = 0; i < n; i++) {
        const int code = listen_on(s, fds[i], err);
        if (code != SHEAR_OK) {
            close_fds(fds + i + 1, n - i - 1);
            return code;
        }
    }
    s->accepting = true;
    return SHEAR_OK;
}

static int start_listening(server *s, const server_options *o, shear_error *err) {
    if (o->n_fds > 0)
        return listen_on_all(s, o->fds, o->n_fds, err);
    int fd = -1;
    TRY(socket_file_make(&s->file, &fd, o->path, o->mode, o->group, err));
    return listen_on_all(s, &fd, 1, err);
}

void server_sockets(const server *s, char *out, size_t size) {
    out[0] = '\0';
    for (size_t i = 0; i < s->n_listeners; i++) {
        char path[256];
        size_t n = sizeof path - 1;
        if (uv_pipe_getsockname(&s->listeners[i], path, &n) != 0 || n == 0)
            n = (size_t)snprintf(path, sizeof path, "(unnamed)");
        path[n] = '\0';
        text_append_item(out, size, path);
    }
}

/* ---- opening ---- */

static void start_handles(server *s) {
    scheduler_init(s, (scheduler_calls){.process = connection_process,
                                        .flush = connection_flush,
                                        .accept = accept_waiting});
    uv_timer_init(s->loop, &s->tick);
    uv_timer_init(s->loop, &s->deadline);
    s->tick.data = s->deadline.data = s;
    s->handles += 2;
    start_tick(s);
}

/* Create a server without handles. Return NULL if out of memory. */
static server *make(const server_options *options, uv_loop_t *loop) {
    server *s = calloc(1, sizeof *s);
    if (s == NULL)
        return NULL;
    s->loop = loop;
    s->handlers = options->handlers;
    s->file.lock = -1;
    TAILQ_INIT(&s->subscribers);
    s->limits = within_bounds(options->limits);
    server_set_defaults(s, options->defaults);
    if (!accept_init(s)) {
        lifetime_free(s);
        return NULL;
    }
    return s;
}

int server_open(server **out, uv_loop_t *loop, const server_options *options, shear_error *err) {
    *out = NULL;
    server *s = make(options, loop);
    if (s == NULL) {
        close_fds(options->fds, options->n_fds);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the server");
    }
    /* libuv writes with write(2): SIGPIPE of a closed connection would kill the process. */
    signal(SIGPIPE, SIG_IGN);
    start_handles(s);
    const int code = start_listening(s, options, err);
    if (code != SHEAR_OK) {
        server_close(s, 0, NULL, NULL); /* freed when the loop has closed the handles */
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

/* ---- closing ---- */

void server_stop_accepting(server *s) {
    s->accepting = false;
    socket_file_remove(&s->file);
    for (size_t i = 0; i < s->n_listeners; i++)
        lifetime_close_handle(&s->listeners[i]);
}

static void on_deadline(uv_timer_t *timer) {
    server *s = timer->data;
    connection_table_each(s, connection_close);
    lifetime_end_if_empty(s);
}

static void say_stopping(connection *c) {
    sheard_rpc_error error;
    sheard_rpc_fail(&error, SHEARD_RPC_STOPPING, NULL, "the service stops");
    while (c->open.n > 0)
        server_reply_error(c->server, (server_handle){c->id, c->open.items[0]->number}, &error);
    connection_finish(c);
}

void server_close(server *s, int64_t flush_ms, void (*done)(void *context), void *context) {
    const uint64_t ms = flush_ms > 0 ? (uint64_t)flush_ms : 0;
    if (s->closing) {
        if (ms < uv_timer_get_due_in(&s->deadline))
            uv_timer_start(&s->deadline, on_deadline, ms, 0);
        return;
    }
    s->closing = true;
    s->done = done;
    s->done_context = context;
    server_stop_accepting(s);
    connection_table_each(s, say_stopping);
    /* Without connections there is nothing to wait for. */
    uv_timer_start(&s->deadline, on_deadline, s->statistics.connections > 0 ? ms : 0, 0);
}

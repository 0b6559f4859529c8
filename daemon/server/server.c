/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/server.h"

#include "server/internal.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A connection's number: its serial number and, in the low bits, its slot. */
enum { SLOT_BITS = 20, MAX_SLOTS = 1 << SLOT_BITS, BACKLOG = 4096, MAX_TICK_MS = 1000 };

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

/* ---- connections ---- */

connection *server_find(const server *s, uint64_t id) {
    const size_t slot = id % MAX_SLOTS;
    connection *c = slot < s->n_slots ? s->slots[slot] : NULL;
    return c != NULL && c->id == id ? c : NULL;
}

static bool add_slots(server *s) {
    const size_t n = s->n_slots != 0 ? 2 * s->n_slots : 16;
    connection **slots = n <= MAX_SLOTS ? realloc(s->slots, n * sizeof(connection *)) : NULL;
    s->slots = slots != NULL ? slots : s->slots;
    size_t *free_slots = slots != NULL ? realloc(s->free_slots, n * sizeof *free_slots) : NULL;
    s->free_slots = free_slots != NULL ? free_slots : s->free_slots;
    if (free_slots == NULL) {
        return false;
    }
    for (size_t i = n; i-- > s->n_slots;) {
        s->slots[i] = NULL;
        s->free_slots[s->n_free++] = i;
    }
    s->n_slots = n;
    return true;
}

bool server_enter(server *s, connection *c) {
    if (s->n_free == 0 && !add_slots(s)) {
        return false;
    }
    const size_t slot = s->free_slots[--s->n_free];
    s->slots[slot] = c;
    c->id = ++s->serial * MAX_SLOTS + slot;
    s->statistics.connections++;
    c->user->connections++;
    return true;
}

void server_leave(server *s, connection *c) {
    const size_t slot = c->id % MAX_SLOTS;
    s->slots[slot] = NULL;
    s->free_slots[s->n_free++] = slot;
    s->statistics.connections--;
    c->user->connections--;
    turns_leave(s, c);
    if (c->subscribed) {
        TAILQ_REMOVE(&s->subscribers, c, subscriber_link);
        c->subscribed = false;
        s->statistics.subscribers--;
    }
    if (s->handlers.closed != NULL) {
        s->handlers.closed(s->handlers.context, c->id);
    }
}

/* ---- time ---- */

static void on_tick(uv_timer_t *timer) {
    server *s = timer->data;
    const uint64_t now = uv_now(s->loop);
    for (size_t i = 0; i < s->n_slots; i++) {
        if (s->slots[i] != NULL) {
            connection_tick(s->slots[i], now);
        }
    }
    if (s->starved) {
        s->starved = false;
        server_accept(s);
    }
}

/* Often enough for the shortest of the times, at least once a second. */
static void start_tick(server *s) {
    int64_t ms = MAX_TICK_MS;
    const int64_t times[] = {s->limits.idle_timeout_ms, s->limits.stall_timeout_ms,
                             s->limits.crowded_ms};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        if (times[i] > 0 && times[i] / 4 < ms) {
            ms = times[i] / 4 + 1;
        }
    }
    uv_timer_start(&s->tick, on_tick, (uint64_t)ms, (uint64_t)ms);
}

/* ---- limits ---- */

static size_t or_default(size_t given, size_t initial) {
    return given != 0 ? given : initial;
}

static size_t at_most(size_t n, size_t most) {
    return n < most ? n : most;
}

static void fill_limits(server *s, const server_limits *given) {
    server_limits d;
    server_limits_init(&d);
    server_limits *l = &s->limits;
    *l = (server_limits){
        .line_bytes = or_default(given->line_bytes, d.line_bytes),
        .connections = or_default(given->connections, d.connections),
        .reserved_connections = or_default(given->reserved_connections, d.reserved_connections),
        .in_flight = or_default(given->in_flight, d.in_flight),
        .subscriptions = or_default(given->subscriptions, d.subscriptions),
        .queue_bytes = or_default(given->queue_bytes, d.queue_bytes),
        .unsent_bytes = or_default(given->unsent_bytes, d.unsent_bytes),
        .slice_us = or_default(given->slice_us, d.slice_us),
        .idle_timeout_ms = given->idle_timeout_ms,
        .stall_timeout_ms = given->stall_timeout_ms,
        .crowded_ms = given->crowded_ms,
    };
    l->line_bytes = at_most(l->line_bytes, d.line_bytes);
    l->connections = at_most(l->connections, MAX_SLOTS);
    l->reserved_connections = at_most(l->reserved_connections, l->connections / 4);
    l->user_connections = or_default(given->user_connections, l->connections / 4);
    l->user_connections += l->user_connections == 0; /* of very few: one */
}

void server_set_limits(server *s, const server_limits *limits) {
    fill_limits(s, limits);
    if (!s->closing) {
        start_tick(s);
    }
    for (size_t i = 0; i < s->n_slots; i++) {
        if (s->slots[i] != NULL) {
            server_schedule(s, s->slots[i]); /* it may be allowed more now */
        }
    }
}

void server_set_defaults(server *s, const shear_settings *defaults) {
    s->has_defaults = defaults != NULL;
    if (defaults != NULL) {
        s->defaults = *defaults;
    }
}

void server_get_statistics(const server *s, server_statistics *statistics) {
    *statistics = s->statistics;
    statistics->unsent_bytes += s->notice_bytes;
}

/* ---- listening ---- */

static void on_connection(uv_stream_t *listener, int status) {
    server *s = listener->data;
    /* An error (too many descriptors, say) ends the accept of one client; the next is another. */
    if (status == 0 && turns_may_accept(s) && !connection_accept(s, listener)) {
        s->starved = true;
    }
}

/* libuv has the client that was not accepted, and asks for no other before that. */
void server_accept(server *s) {
    for (size_t i = 0; s->accepting && i < s->n_listeners; i++) {
        on_connection((uv_stream_t *)&s->listeners[i], 0);
    }
}

static int listen_on(server *s, int fd, shear_error *err) {
    uv_pipe_t *listener = &s->listeners[s->n_listeners];
    uv_pipe_init(s->loop, listener, 0);
    listener->data = s;
    s->n_listeners++;
    s->handles++;
    int rc = uv_pipe_open(listener, fd);
    if (rc != 0) {
        close(fd);
    }
    rc = rc != 0 ? rc : uv_listen((uv_stream_t *)listener, BACKLOG, on_connection);
    return rc == 0 ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_IO, NULL, "descriptor %d: cannot listen: %s", fd,
                                uv_strerror(rc));
}

static void close_fds(const int *fds, size_t n) {
    for (size_t i = 0; i < n; i++) {
        close(fds[i]);
    }
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
    if (o->n_fds > 0) {
        return listen_on_all(s, o->fds, o->n_fds, err);
    }
    int fd = -1;
    const int code = socket_file_make(&s->file, &fd, o->path, o->mode, o->group, err);
    return code != SHEAR_OK ? code : listen_on_all(s, &fd, 1, err);
}

void server_sockets(const server *s, char *out, size_t size) {
    out[0] = '\0';
    for (size_t i = 0; i < s->n_listeners; i++) {
        char path[256];
        size_t n = sizeof path - 1;
        const size_t used = strlen(out);
        if (uv_pipe_getsockname(&s->listeners[i], path, &n) != 0 || n == 0) {
            n = (size_t)snprintf(path, sizeof path, "(unnamed)");
        }
        path[n] = '\0';
        snprintf(out + used, size - used, "%s%s", used > 0 ? ", " : "", path);
    }
}

/* ---- the beginning ---- */

static void start_handles(server *s) {
    turns_init(s);
    uv_idle_init(s->loop, &s->turn);
    uv_timer_init(s->loop, &s->tick);
    uv_timer_init(s->loop, &s->deadline);
    s->turn.data = s->tick.data = s->deadline.data = s;
    s->handles += 3;
    start_tick(s);
}

static bool make_refusals(server *s) {
    static const char *const texts[SERVER_N_REFUSALS] = {
        "the service has as many connections as it may have ([limits] connections)",
        "you have as many connections as a user may have ([limits] user_connections)"};
    const sheard_rpc_id none = {.type = SHEARD_ID_NULL};
    sheard_rpc_error error;
    int rc = SHEARD_RPC_OK;
    for (int i = 0; i < SERVER_N_REFUSALS && rc == SHEARD_RPC_OK; i++) {
        sheard_rpc_fail(&error, SHEARD_RPC_TOO_MANY_CONNECTIONS, NULL, "%s", texts[i]);
        rc = sheard_error_line(&s->refusal[i], &s->refusal_bytes[i], &none, &error);
    }
    return rc == SHEARD_RPC_OK;
}

static void free_refusals(server *s) {
    for (int i = 0; i < SERVER_N_REFUSALS; i++) {
        free(s->refusal[i]);
    }
}

int server_open(server **out, uv_loop_t *loop, const server_options *options, shear_error *err) {
    server *s = calloc(1, sizeof *s);
    *out = NULL;
    if (s == NULL || !make_refusals(s)) {
        if (s != NULL) {
            free_refusals(s);
        }
        free(s);
        close_fds(options->fds, options->n_fds);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the server");
    }
    /* libuv writes with write(2): a client that has gone would kill the daemon. */
    signal(SIGPIPE, SIG_IGN);
    s->loop = loop;
    s->handlers = options->handlers;
    s->file.lock = -1;
    TAILQ_INIT(&s->subscribers);
    fill_limits(s, &options->limits);
    server_set_defaults(s, options->defaults);
    start_handles(s);
    const int code = start_listening(s, options, err);
    if (code != SHEAR_OK) {
        server_close(s, 0, NULL, NULL); /* freed when the loop has closed its handles */
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

/* ---- the end ---- */

static void free_server(server *s) {
    void (*done)(void *) = s->done;
    void *context = s->done_context;
    free(s->slots);
    free(s->free_slots);
    free_refusals(s);
    free(s);
    if (done != NULL) {
        done(context);
    }
}

static void on_handle_closed(uv_handle_t *handle) {
    server_handle_gone(handle->data);
}

static void close_handle(void *handle) {
    uv_handle_t *h = handle;
    if (uv_is_closing(h) == 0) {
        uv_close(h, on_handle_closed);
    }
}

static void end_if_empty(server *s) {
    if (s->closing && s->statistics.connections == 0) {
        close_handle(&s->turn);
        close_handle(&s->tick);
        close_handle(&s->deadline);
    }
}

void server_handle_gone(server *s) {
    if (--s->handles == 0) {
        free_server(s);
    } else {
        end_if_empty(s);
    }
}

void server_stop_accepting(server *s) {
    s->accepting = false;
    socket_file_remove(&s->file);
    for (size_t i = 0; i < s->n_listeners; i++) {
        close_handle(&s->listeners[i]);
    }
}

static void on_deadline(uv_timer_t *timer) {
    server *s = timer->data;
    for (size_t i = 0; i < s->n_slots; i++) {
        if (s->slots[i] != NULL) {
            connection_close(s->slots[i]);
        }
    }
    end_if_empty(s);
}

static void say_stopping(server *s, connection *c) {
    sheard_rpc_error error;
    sheard_rpc_fail(&error, SHEARD_RPC_STOPPING, NULL, "the service stops");
    while (c->open.n > 0) {
        server_reply_error(s, (server_handle){c->id, c->open.items[0]->number}, &error);
    }
    connection_finish(c);
}

void server_close(server *s, int64_t flush_ms, void (*done)(void *context), void *context) {
    const uint64_t ms = flush_ms > 0 ? (uint64_t)flush_ms : 0;
    if (s->closing) {
        if (ms < uv_timer_get_due_in(&s->deadline)) {
            uv_timer_start(&s->deadline, on_deadline, ms, 0);
        }
        return;
    }
    s->closing = true;
    s->done = done;
    s->done_context = context;
    server_stop_accepting(s);
    for (size_t i = 0; i < s->n_slots; i++) {
        if (s->slots[i] != NULL) {
            say_stopping(s, s->slots[i]);
        }
    }
    /* Without connections there is nothing to wait for. */
    uv_timer_start(&s->deadline, on_deadline, s->statistics.connections > 0 ? ms : 0, 0);
}

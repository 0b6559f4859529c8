/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/connection.h"

#include "server/internal.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

/* At once; and what may be queued before it is written, so that short replies go together. */
enum { WRITE_LINES = 32, WRITE_BYTES = 1 << 18, WRITE_SOON = 1 << 14 };

/* ---- what has gone out ---- */

static void wrote(connection *c, size_t bytes) {
    server *s = c->server;
    const size_t held = c->out.held;
    out_queue_take(&c->out, bytes);
    s->statistics.queued_bytes -= bytes;
    s->statistics.unsent_bytes -= held - c->out.held;
    if (c->user != NULL) {
        c->user->held -= held - c->out.held;
    }
    turns_made_room(s);
}

/* ---- the end ---- */

static void free_connection(connection *c) {
    wrote(c, c->out.bytes);
    if (c->user != NULL) {
        users_part(&c->server->users, c->user);
    }
    sheard_frame_deinit(&c->frame);
    free(c->kept);
    open_requests_deinit(&c->open);
    watched_deinit(&c->watched);
    out_queue_deinit(&c->out);
    access_peer_deinit(&c->peer);
    free(c);
}

static void on_closed(uv_handle_t *handle) {
    connection *c = handle->data;
    server *s = c->server;
    free_connection(c);
    server_handle_gone(s);
}

/* On a Unix socket what has been written stays readable for the client after the close, so there
 * is nothing to linger for. */
void connection_close(connection *c) {
    if (!c->closed) {
        c->closed = true;
        server_leave(c->server, c);
        uv_close((uv_handle_t *)&c->pipe, on_closed);
    }
}

static void drop_input(connection *c) {
    free(c->kept);
    c->kept = NULL;
    c->input = NULL;
    c->n_input = 0;
}

void connection_finish(connection *c) {
    c->finishing = true;
    server_schedule(c->server, c);
}

void connection_doom(connection *c) {
    c->doomed = true;
    server_schedule(c->server, c);
}

static bool is_over(const connection *c) {
    if (c->doomed) {
        return true;
    }
    if (c->out.n > 0 || (!c->finishing && !c->ended)) {
        return false;
    }
    return c->finishing || (c->n_input == 0 && c->open.n == 0 && !watched_anything(&c->watched));
}

/* ---- out ---- */

static bool queue(connection *c, out_text *text) {
    if (c->out.n == 0) {
        c->progress_ms = uv_now(c->server->loop);
    }
    const size_t held = c->out.held;
    if (!out_queue_push(&c->out, text)) {
        return false;
    }
    c->server->statistics.queued_bytes += text->n;
    c->server->statistics.unsent_bytes += c->out.held - held;
    c->user->held += c->out.held - held;
    turns_flush_later(c->server, c);
    return true;
}

void connection_send(connection *c, out_text *text) {
    if (!c->closed && !c->doomed) {
        if (c->out.bytes > c->server->limits.queue_bytes) {
            c->server->statistics.dropped++;
            connection_doom(c);
        } else if (text == NULL || !queue(c, text)) {
            connection_doom(c);
        }
    }
    out_text_drop(text);
}

static bool has_room_for_notice(const connection *c, const out_text *text) {
    const server *s = c->server;
    const size_t most = s->limits.queue_bytes / 4 < SERVER_NOTICE_BYTES ? s->limits.queue_bytes / 4
                                                                        : SERVER_NOTICE_BYTES;
    return c->out.n < SERVER_NOTICES && c->out.bytes + text->n <= most &&
           (c->out.n == 0 || s->notice_bytes <= s->limits.unsent_bytes / 4);
}

/* Once one is left out, all are, until the client has been told: so it knows where the gap is. */
void connection_notify(connection *c, out_text *text) {
    server *s = c->server;
    if (c->closed || c->doomed || c->finishing) {
        return;
    }
    if (c->lost > 0 || text == NULL || !has_room_for_notice(c, text) || !queue(c, text)) {
        c->lost++;
        s->statistics.lost++;
    } else {
        s->statistics.notices++;
    }
}

static void tell_lost(connection *c) {
    if (c->lost == 0 || c->finishing || c->out.bytes > c->server->limits.queue_bytes / 16) {
        return;
    }
    const sheard_notice_params params = {.lost.count = (int64_t)c->lost};
    sheard_rpc_error error;
    char *line;
    size_t n;
    sheard_notice_line(&line, &n, SHEARD_NOTICE_LOST, &params, &error);
    c->lost = 0;
    connection_send(c, out_text_new(line, n));
}

void connection_send_error(connection *c, const sheard_rpc_id *id, const sheard_rpc_error *error) {
    char *line;
    size_t n;
    c->server->statistics
        .errors[error->code > 0 && error->code < SHEARD_N_RPC_CODES ? error->code
                                                                    : SHEARD_RPC_UNKNOWN]++;
    if (sheard_error_line(&line, &n, id, error) != SHEARD_RPC_OK) {
        line = strdup(sheard_rpc_no_memory_line);
        n = strlen(sheard_rpc_no_memory_line);
    }
    connection_send(c, out_text_new(line, n));
}

static void on_written(uv_write_t *write, int status) {
    connection *c = write->data;
    server *s = c->server;
    if (c->closed) {
        return; /* the queue goes with the connection */
    }
    if (status < 0) {
        connection_close(c);
        return;
    }
    const size_t written = c->writing;
    c->writing = 0;
    s->statistics.bytes_out += written;
    wrote(c, written);
    c->progress_ms = uv_now(s->loop);
    if (c->out.n > 0) {
        turns_flush_later(s, c);
    }
    server_schedule(s, c);
}

/* The oldest lines, into bufs[WRITE_LINES]. */
static unsigned gather(const out_queue *q, uv_buf_t *bufs, size_t *bytes) {
    size_t skip = q->written;
    size_t n = 0;
    *bytes = 0;
    while (n < q->n && n < WRITE_LINES && *bytes < WRITE_BYTES) {
        const out_text *text = out_queue_at(q, n);
        bufs[n++] = (uv_buf_t){.base = text->bytes + skip, .len = text->n - skip};
        *bytes += text->n - skip;
        skip = 0;
    }
    return (unsigned)n;
}

/* What the socket takes now; the rest, once it takes more, by libuv. */
static void flush(connection *c) {
    uv_buf_t bufs[WRITE_LINES];
    size_t bytes;
    while (c->writing == 0 && c->out.n > 0 && !c->doomed) {
        unsigned n = gather(&c->out, bufs, &bytes);
        const int rc = uv_try_write((uv_stream_t *)&c->pipe, bufs, n);
        const size_t written = rc > 0 ? (size_t)rc : 0;
        c->server->statistics.bytes_out += written;
        wrote(c, written);
        if (written > 0) {
            c->progress_ms = uv_now(c->server->loop);
        }
        if (written == bytes) {
            continue;
        }
        n = gather(&c->out, bufs, &c->writing);
        c->write.data = c;
        if ((rc < 0 && rc != UV_EAGAIN) ||
            uv_write(&c->write, (uv_stream_t *)&c->pipe, bufs, n, on_written) != 0) {
            c->writing = 0;
            connection_doom(c);
        }
    }
}

/* ---- in ---- */

static void give_scratch(uv_handle_t *handle, size_t suggested, uv_buf_t *buf) {
    (void)suggested;
    server *s = ((connection *)handle->data)->server;
    *buf = (uv_buf_t){.base = s->scratch, .len = sizeof s->scratch};
}

/* It waits for the connection's turns, and nothing more is read until it is used up. */
static void keep_input(connection *c, const char *input, size_t n) {
    c->kept = malloc(n);
    if (c->kept == NULL) {
        connection_doom(c);
        return;
    }
    memcpy(c->kept, input, n);
    c->input = c->kept;
    c->n_input = n;
}

/* A client that has only shut down its writing side (printf | nc -N) still wants its replies; one
 * that has closed the socket does not. */
static bool has_gone(const connection *c) {
    int fd = -1;
    if (uv_fileno((const uv_handle_t *)&c->pipe, &fd) != 0) {
        return false;
    }
    struct pollfd p = {.fd = fd};
    return poll(&p, 1, 0) > 0 && (p.revents & (POLLHUP | POLLERR)) != 0;
}

static void settle(connection *c);

static void on_read(uv_stream_t *stream, ssize_t n, const uv_buf_t *buf) {
    connection *c = stream->data;
    if (n > 0) {
        c->server->statistics.bytes_in += (uint64_t)n;
        keep_input(c, buf->base, (size_t)n);
        settle(c);
    } else if (n == UV_EOF) {
        c->ended = true;
        c->doomed = c->doomed || has_gone(c);
        server_schedule(c->server, c); /* in its turn: a thousand may go at once */
    } else if (n < 0) {
        connection_doom(c);
    }
}

/* Close it, or read on, or not; and come back where there are lines left. */
static void settle(connection *c) {
    if (is_over(c)) {
        connection_close(c);
        return;
    }
    const bool may_take = connection_may_take(c);
    if (may_take && c->n_input > 0) {
        server_schedule(c->server, c);
    }
    const bool read = may_take && c->n_input == 0 && !c->ended;
    if (may_take && c->held_up && c->partial_ms != 0) {
        c->partial_ms = uv_now(c->server->loop); /* it was not the client's fault till now */
    }
    c->held_up = !may_take;
    if (read && !c->reading) {
        c->reading = uv_read_start((uv_stream_t *)&c->pipe, give_scratch, on_read) == 0;
        if (!c->reading) {
            connection_doom(c);
        }
    } else if (!read && c->reading) {
        uv_read_stop((uv_stream_t *)&c->pipe);
        c->reading = false;
    }
}

static bool may_go_on(const connection *c) {
    return !c->finishing && !c->doomed && (c->writing == 0 || c->user->at_work == c);
}

/* A step of the work of the request that has waited for it longest. */
static void go_on(connection *c, open_request *r) {
    server *s = c->server;
    if (!turns_may_work(s, c)) {
        return;
    }
    s->in_step = r;
    const int next = r->work.step(r->work.context);
    if (s->in_step != NULL) {
        s->in_step = NULL;
        if (next == SERVER_MORE) {
            server_schedule(s, c);
            return;
        }
        open_requests_pause(&c->open, r);
    } else { /* answered */
        open_requests_remove(&c->open, r->number);
    }
    turns_end_work(s, c);
    server_schedule(s, c);
}

void connection_turn(connection *c) {
    tell_lost(c);
    if (c->out.bytes > WRITE_SOON) {
        flush(c);
    }
    open_request *r = TAILQ_FIRST(&c->open.awake);
    const bool may_take = c->n_input > 0 && connection_may_take(c);
    if ((r != NULL || may_take) && has_gone(c)) {
        connection_close(c);
        return;
    }
    if (may_take) {
        connection_take_line(c);
    } else if (r != NULL && may_go_on(c)) {
        go_on(c, r);
    } else if (r != NULL) {
        turns_end_work(c->server, c); /* nobody waits for one that does not read */
    }
    if (c->n_input == 0 || c->finishing) {
        drop_input(c);
    }
    settle(c);
}

void connection_flush(connection *c) {
    flush(c);
    if (c->lost > 0 || !TAILQ_EMPTY(&c->open.awake)) {
        server_schedule(c->server, c);
    }
    settle(c);
}

/* ---- time ---- */

static bool is_stalled(connection *c, uint64_t now) {
    const server_limits *limits = &c->server->limits;
    const int64_t limit = limits->crowded_ms > 0 && turns_is_crowded(c->server, c->user)
                              ? limits->crowded_ms
                              : limits->stall_timeout_ms;
    const size_t unwritten = uv_stream_get_write_queue_size((uv_stream_t *)&c->pipe);
    if (unwritten != c->unwritten) {
        c->unwritten = unwritten;
        c->progress_ms = now;
    }
    return c->out.n > 0 && limit > 0 && now - c->progress_ms >= (uint64_t)limit;
}

static bool is_idle(const connection *c, uint64_t now) {
    const int64_t limit = c->server->limits.idle_timeout_ms;
    if (limit <= 0 || c->finishing || c->ended || c->n_input > 0) {
        return false;
    }
    const bool silent = c->open.n == 0 && c->out.n == 0 && !watched_anything(&c->watched) &&
                        now - c->active_ms >= (uint64_t)limit;
    return silent || (c->reading && c->partial_ms != 0 && now - c->partial_ms >= (uint64_t)limit);
}

void connection_tick(connection *c, uint64_t now) {
    server *s = c->server;
    if (has_gone(c)) {
        connection_close(c);
    } else if (is_stalled(c, now)) {
        s->statistics.dropped++;
        connection_close(c);
    } else if (is_idle(c, now)) {
        const sheard_rpc_id none = {.type = SHEARD_ID_NULL};
        sheard_rpc_error error;
        s->statistics.timeouts++;
        sheard_rpc_fail(&error, SHEARD_RPC_IDLE_TIMEOUT, NULL, "nothing came for %lld s",
                        (long long)(s->limits.idle_timeout_ms / 1000));
        connection_send_error(c, &none, &error);
        connection_finish(c);
    }
}

/* ---- the beginning ---- */

static bool begin(connection *c) {
    const server_handlers *h = &c->server->handlers;
    int fd = -1;
    if (uv_fileno((const uv_handle_t *)&c->pipe, &fd) != 0 ||
        access_peer_from_socket(fd, &c->peer, NULL) != SHEAR_OK) {
        return false;
    }
    c->user = users_join(&c->server->users, c->peer.uid, c->server->clock_ns);
    c->is_admin = h->is_admin != NULL && h->is_admin(h->context, &c->peer);
    return c->user != NULL;
}

/* Which limit forbids it; SERVER_N_REFUSALS: none. */
static int find_refusal(const connection *c) {
    const server *s = c->server;
    const server_limits *l = &s->limits;
    const size_t reserved =
        c->is_admin || s->handlers.is_admin == NULL ? 0 : l->reserved_connections;
    return s->statistics.connections + reserved >= l->connections        ? SERVER_ALL_CONNECTIONS
           : !c->is_admin && c->user->connections >= l->user_connections ? SERVER_USER_CONNECTIONS
                                                                         : SERVER_N_REFUSALS;
}

/* The socket's buffer is empty: the line is written at once, or not at all. */
static void refuse(connection *c, int why) {
    server *s = c->server;
    uv_buf_t buf = {.base = s->refusal[why], .len = s->refusal_bytes[why]};
    s->statistics.refused++;
    if (uv_try_write((uv_stream_t *)&c->pipe, &buf, 1) > 0) {
        s->statistics.errors[SHEARD_RPC_TOO_MANY_CONNECTIONS]++;
    }
}

static bool let_in(connection *c) {
    if (!begin(c)) {
        return false;
    }
    const int refusal = find_refusal(c);
    if (refusal != SERVER_N_REFUSALS) {
        refuse(c, refusal);
    }
    return refusal == SERVER_N_REFUSALS && server_enter(c->server, c);
}

bool connection_accept(server *s, uv_stream_t *listener) {
    connection *c = calloc(1, sizeof *c);
    if (c == NULL) {
        return false;
    }
    c->server = s;
    c->active_ms = uv_now(s->loop);
    sheard_frame_init(&c->frame, s->limits.line_bytes);
    open_requests_init(&c->open);
    uv_pipe_init(s->loop, &c->pipe, 0);
    c->pipe.data = c;
    s->handles++;
    if (uv_accept(listener, (uv_stream_t *)&c->pipe) == 0 && let_in(c)) {
        s->statistics.accepted++;
        settle(c);
    } else {
        c->closed = true;
        uv_close((uv_handle_t *)&c->pipe, on_closed);
    }
    return true;
}

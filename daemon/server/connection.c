/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/connection.h"

#include "server/inner.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

enum { WRITE_LINES = 32, WRITE_BYTES = 1 << 18 }; /* at once */

/* ---- the end ---- */

static void free_connection(connection *c) {
    c->server->statistics.queued_bytes -= c->out.bytes;
    shear_frame_deinit(&c->frame);
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

static void doom(connection *c) {
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
    if (!out_queue_push(&c->out, text)) {
        return false;
    }
    c->server->statistics.queued_bytes += text->n;
    server_schedule(c->server, c);
    return true;
}

void connection_send(connection *c, out_text *text) {
    if (!c->closed && !c->doomed) {
        if (c->out.bytes > c->server->limits.queue_bytes) {
            c->server->statistics.dropped++;
            doom(c);
        } else if (!text || !queue(c, text)) {
            doom(c);
        }
    }
    out_text_drop(text);
}

/* Beyond a quarter of what would end the connection. Once one is left out, all are, until the
 * client has been told: so it knows where the gap is. */
void connection_notify(connection *c, out_text *text) {
    server *s = c->server;
    if (c->closed || c->doomed || c->finishing) {
        return;
    }
    if (c->lost > 0 || c->out.bytes + text->n > s->limits.queue_bytes / 4 || !queue(c, text)) {
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
    const shear_notice_params params = {.lost.count = (int64_t)c->lost};
    shear_rpc_error error;
    char *line;
    size_t n;
    shear_notice_line(&line, &n, SHEAR_NOTICE_LOST, &params, &error);
    c->lost = 0;
    connection_send(c, out_text_new(line, n));
}

void connection_send_error(connection *c, const shear_rpc_id *id, const shear_rpc_error *error) {
    char *line;
    size_t n;
    c->server->statistics
        .errors[error->code > 0 && error->code < SHEAR_N_RPC_CODES ? error->code
                                                                   : SHEAR_RPC_UNKNOWN]++;
    if (shear_error_line(&line, &n, id, error) != SHEAR_RPC_OK) {
        line = strdup(shear_rpc_no_memory_line);
        n = strlen(shear_rpc_no_memory_line);
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
    const size_t before = c->out.bytes;
    out_queue_pop(&c->out, c->writing);
    c->writing = 0;
    s->statistics.bytes_out += before - c->out.bytes;
    s->statistics.queued_bytes -= before - c->out.bytes;
    c->progress_ms = uv_now(s->loop);
    server_schedule(s, c);
}

static void flush(connection *c) {
    uv_buf_t bufs[WRITE_LINES];
    size_t n = 0;
    size_t bytes = 0;
    if (c->writing > 0 || c->out.n == 0 || c->doomed) {
        return;
    }
    while (n < c->out.n && n < WRITE_LINES && bytes < WRITE_BYTES) {
        const out_text *text = out_queue_at(&c->out, n);
        bufs[n++] = (uv_buf_t){.base = text->bytes, .len = text->n};
        bytes += text->n;
    }
    c->write.data = c;
    if (uv_write(&c->write, (uv_stream_t *)&c->pipe, bufs, (unsigned)n, on_written) == 0) {
        c->writing = n;
    } else {
        doom(c);
    }
}

/* ---- in ---- */

static void give_scratch(uv_handle_t *handle, size_t suggested, uv_buf_t *buf) {
    (void)suggested;
    server *s = ((connection *)handle->data)->server;
    *buf = (uv_buf_t){.base = s->scratch, .len = sizeof s->scratch};
}

/* What the limits did not let us take waits in memory of its own, and nothing more is read until it
 * is used up. */
static void keep_input(connection *c) {
    if (c->finishing || c->n_input == 0) {
        drop_input(c);
    } else if (!c->kept) {
        c->kept = malloc(c->n_input);
        if (!c->kept) {
            drop_input(c);
            doom(c);
            return;
        }
        memcpy(c->kept, c->input, c->n_input);
        c->input = c->kept;
    }
}

/* A client that has only shut down its writing side (printf | nc -N) still wants its replies; one
 * that has closed the socket does not. */
static bool has_gone(connection *c) {
    int fd = -1;
    if (!c->ended || uv_fileno((const uv_handle_t *)&c->pipe, &fd) != 0) {
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
        c->input = buf->base;
        c->n_input = (size_t)n;
        connection_take_lines(c);
        keep_input(c);
    } else if (n == UV_EOF) {
        c->ended = true;
        c->doomed = c->doomed || has_gone(c);
    } else if (n < 0) {
        doom(c);
    }
    settle(c);
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
    if (read && !c->reading) {
        c->reading = uv_read_start((uv_stream_t *)&c->pipe, give_scratch, on_read) == 0;
        if (c->partial_ms != 0) {
            c->partial_ms = uv_now(c->server->loop); /* it was not the client's fault till now */
        }
        if (!c->reading) {
            doom(c);
        }
    } else if (!read && c->reading) {
        uv_read_stop((uv_stream_t *)&c->pipe);
        c->reading = false;
    }
}

void connection_turn(connection *c) {
    c->lines = 0;
    tell_lost(c);
    if (c->n_input > 0) {
        connection_take_lines(c);
        keep_input(c);
    }
    flush(c);
    settle(c);
}

/* ---- time ---- */

static bool is_stalled(connection *c, uint64_t now) {
    const int64_t limit = c->server->limits.stall_timeout_ms;
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
        const shear_rpc_id none = {.type = SHEAR_ID_NULL};
        shear_rpc_error error;
        s->statistics.timeouts++;
        shear_rpc_fail(&error, SHEAR_RPC_IDLE_TIMEOUT, NULL, "nothing came for %lld s",
                       (long long)(s->limits.idle_timeout_ms / 1000));
        connection_send_error(c, &none, &error);
        connection_finish(c);
    }
}

/* ---- the beginning ---- */

static bool begin(connection *c) {
    int fd = -1;
    if (uv_fileno((const uv_handle_t *)&c->pipe, &fd) != 0 ||
        access_peer_from_socket(fd, &c->peer, NULL) != SHEAR_OK) {
        return false;
    }
    return server_enter(c->server, c);
}

/* The socket's buffer is empty: the line is written at once, or not at all. */
static void refuse(connection *c) {
    server *s = c->server;
    uv_buf_t buf = {.base = s->refusal, .len = s->refusal_bytes};
    s->statistics.refused++;
    if (uv_try_write((uv_stream_t *)&c->pipe, &buf, 1) > 0) {
        s->statistics.errors[SHEAR_RPC_TOO_MANY_CONNECTIONS]++;
    }
    c->closed = true;
    uv_close((uv_handle_t *)&c->pipe, on_closed);
}

bool connection_accept(server *s, uv_stream_t *listener) {
    connection *c = calloc(1, sizeof *c);
    if (!c) {
        return false;
    }
    c->server = s;
    c->active_ms = uv_now(s->loop);
    shear_frame_init(&c->frame, s->limits.line_bytes);
    uv_pipe_init(s->loop, &c->pipe, 0);
    c->pipe.data = c;
    s->handles++;
    const bool accepted = uv_accept(listener, (uv_stream_t *)&c->pipe) == 0;
    if (accepted && s->statistics.connections >= s->limits.connections) {
        refuse(c);
    } else if (accepted && begin(c)) {
        s->statistics.accepted++;
        settle(c);
    } else {
        c->closed = true;
        uv_close((uv_handle_t *)&c->pipe, on_closed);
    }
    return true;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/connection_loop.h"

#include "server/dispatch.h"
#include "server/internal.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

/* Bytes that may be queued before they are written, so that short replies go together. */
enum { WRITE_SOON = 1 << 14 };

static void drop_input(connection *c) {
    free(c->kept);
    c->kept = NULL;
    c->input = NULL;
    c->n_input = 0;
}

static bool is_over(const connection *c) {
    if (c->aborted)
        return true;
    if (c->out.n > 0 || (!c->finishing && !c->ended))
        return false;
    return c->finishing ||
           (c->n_input == 0 && c->open.n == 0 && !subscriptions_any(&c->subscriptions));
}

/* ---- input ---- */

static void give_buffer(uv_handle_t *handle, size_t suggested, uv_buf_t *buf) {
    (void)suggested;
    server *s = ((connection *)handle->data)->server;
    *buf = (uv_buf_t){.base = s->buffer, .len = sizeof s->buffer};
}

/* Keep the input for later. Nothing more is read until it is used up. */
static void keep_input(connection *c, const char *input, size_t n) {
    c->kept = malloc(n);
    if (c->kept == NULL) {
        connection_abort(c);
        return;
    }
    memcpy(c->kept, input, n);
    c->input = c->kept;
    c->n_input = n;
}

/* Return whether the client has closed the socket. One that has only shut down its writing side
 * (printf | nc -N) still wants its replies. */
static bool has_gone(const connection *c) {
    int fd = -1;
    if (uv_fileno((const uv_handle_t *)&c->pipe, &fd) != 0)
        return false;
    struct pollfd p = {.fd = fd};
    return poll(&p, 1, 0) > 0 && (p.revents & (POLLHUP | POLLERR)) != 0;
}

static void update(connection *c);

static void on_read(uv_stream_t *stream, ssize_t n, const uv_buf_t *buf) {
    connection *c = stream->data;
    if (n > 0) {
        c->server->statistics.bytes_in += (uint64_t)n;
        keep_input(c, buf->base, (size_t)n);
        update(c);
    } else if (n == UV_EOF) {
        c->ended = true;
        c->aborted = c->aborted || has_gone(c);
        scheduler_add(c->server, c); /* not now: a thousand connections may end at once */
    } else if (n < 0) {
        connection_abort(c);
    }
}

/* Close the connection, or start or stop reading, and schedule it if lines are left. */
static void update(connection *c) {
    if (is_over(c)) {
        connection_close(c);
        return;
    }
    const bool may_take = dispatch_is_allowed(c);
    if (may_take && c->n_input > 0)
        scheduler_add(c->server, c);
    const bool read = may_take && c->n_input == 0 && !c->ended;
    if (may_take && c->held_up && c->partial_ms != 0) {
        c->partial_ms = uv_now(c->server->loop); /* the delay so far was not the client's fault */
    }
    c->held_up = !may_take;
    if (read && !c->reading) {
        c->reading = uv_read_start((uv_stream_t *)&c->pipe, give_buffer, on_read) == 0;
        if (!c->reading)
            connection_abort(c);
    } else if (!read && c->reading) {
        uv_read_stop((uv_stream_t *)&c->pipe);
        c->reading = false;
    }
}

static bool may_go_on(const connection *c) {
    return !c->finishing && !c->aborted && (c->writing == 0 || c->user->at_work == c);
}

/* Run one step of the deferred work that has waited longest. */
static void go_on(connection *c, open_request *r) {
    server *s = c->server;
    if (!scheduler_may_work(s, c))
        return;
    s->in_step = r;
    const enum server_step next = r->work.step(r->work.context);
    if (s->in_step != NULL) {
        s->in_step = NULL;
        if (next == SERVER_MORE) {
            scheduler_add(s, c);
            return;
        }
        open_requests_pause(&c->open, r);
    } else { /* answered */
        open_requests_remove(&c->open, r);
    }
    scheduler_end_work(s, c);
    scheduler_add(s, c);
}

void connection_process(connection *c) {
    connection_tell_lost(c);
    if (c->out.bytes > WRITE_SOON)
        connection_write(c);
    open_request *r = TAILQ_FIRST(&c->open.awake);
    const bool may_take = c->n_input > 0 && dispatch_is_allowed(c);
    if ((r != NULL || may_take) && has_gone(c)) {
        connection_close(c);
        return;
    }
    if (may_take) {
        dispatch_line(c);
    } else if (r != NULL && may_go_on(c)) {
        go_on(c, r);
    } else if (r != NULL) {
        scheduler_end_work(c->server, c); /* others do not wait for a client that does not read */
    }
    if (c->n_input == 0 || c->finishing)
        drop_input(c);
    update(c);
}

void connection_flush(connection *c) {
    connection_write(c);
    if (c->lost > 0 || !TAILQ_EMPTY(&c->open.awake))
        scheduler_add(c->server, c);
    update(c);
}

void connection_start(connection *c) {
    update(c);
}

/* ---- timeouts ---- */

static bool is_stalled(connection *c, uint64_t now) {
    const server_limits *limits = &c->server->limits;
    const int64_t limit = limits->crowded_ms > 0 && scheduler_is_crowded(c->server, c->user)
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
    if (limit <= 0 || c->finishing || c->ended || c->n_input > 0)
        return false;
    const bool silent = c->open.n == 0 && c->out.n == 0 && !subscriptions_any(&c->subscriptions) &&
                        now - c->active_ms >= (uint64_t)limit;
    return silent || (c->reading && c->partial_ms != 0 && now - c->partial_ms >= (uint64_t)limit);
}

void connection_tick(connection *c) {
    server *s = c->server;
    const uint64_t now = uv_now(s->loop);
    if (has_gone(c)) {
        connection_close(c);
    } else if (is_stalled(c, now)) {
        s->statistics.dropped++;
        connection_close(c);
    } else if (is_idle(c, now)) {
        sheard_rpc_error error;
        s->statistics.timeouts++;
        sheard_rpc_fail(&error, SHEARD_RPC_IDLE_TIMEOUT, NULL, "nothing came for %lld s",
                        (long long)(s->limits.idle_timeout_ms / 1000));
        connection_send_error(c, NULL, &error);
        connection_finish(c);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/connection.h"

#include "server/internal.h"
#include "server/lifetime.h"

#include <stdlib.h>
#include <string.h>

/* Limits of one call of write. */
enum { WRITE_LINES = 32, WRITE_BYTES = 1 << 18 };

/* ---- accounting of written bytes ---- */

static void wrote(connection *c, size_t bytes) {
    server *s = c->server;
    const size_t held = c->out.held;
    out_queue_consume(&c->out, bytes);
    s->statistics.queued_bytes -= bytes;
    s->statistics.unsent_bytes -= held - c->out.held;
    if (c->user != NULL)
        c->user->held -= held - c->out.held;
    scheduler_note_freed(s);
}

/* ---- closing ---- */

static void free_connection(connection *c) {
    wrote(c, c->out.bytes);
    if (c->user != NULL)
        users_part(&c->server->scheduler.users, c->user);
    sheard_frame_deinit(&c->frame);
    free(c->kept);
    open_requests_deinit(&c->open);
    subscriptions_deinit(&c->subscriptions);
    out_queue_deinit(&c->out);
    access_peer_deinit(&c->peer);
    free(c);
}

void connection_on_closed(uv_handle_t *handle) {
    connection *c = handle->data;
    server *s = c->server;
    free_connection(c);
    lifetime_handle_closed(s);
}

/* What has been written to a Unix socket stays readable for the client after the close, so no
 * lingering is needed. */
void connection_close(connection *c) {
    if (!c->closed) {
        c->closed = true;
        connection_table_leave(c->server, c);
        uv_close((uv_handle_t *)&c->pipe, connection_on_closed);
    }
}

void connection_finish(connection *c) {
    c->finishing = true;
    scheduler_add(c->server, c);
}

void connection_abort(connection *c) {
    c->aborted = true;
    scheduler_add(c->server, c);
}

/* ---- output ---- */

static bool queue(connection *c, out_line *line) {
    if (c->out.n == 0)
        c->progress_ms = uv_now(c->server->loop);
    const size_t held = c->out.held;
    if (!out_queue_push(&c->out, line))
        return false;
    c->server->statistics.queued_bytes += line->n;
    c->server->statistics.unsent_bytes += c->out.held - held;
    c->user->held += c->out.held - held;
    scheduler_flush_later(c->server, c);
    return true;
}

void connection_send(connection *c, out_line *line) {
    if (!c->closed && !c->aborted) {
        if (c->out.bytes > c->server->limits.queue_bytes) {
            c->server->statistics.dropped++;
            connection_abort(c);
        } else if (line == NULL || !queue(c, line)) {
            connection_abort(c);
        }
    }
    out_line_unref(line);
}

static bool has_room_for_notice(const connection *c, const out_line *line) {
    const server *s = c->server;
    const size_t most = s->limits.queue_bytes / 4 < SERVER_NOTICE_BYTES ? s->limits.queue_bytes / 4
                                                                        : SERVER_NOTICE_BYTES;
    return c->out.n < SERVER_NOTICES && c->out.bytes + line->n <= most &&
           (c->out.n == 0 || s->notice_bytes <= s->limits.unsent_bytes / 4);
}

/* After one notification is left out, all are, until the client gets `lost`: so it can locate the
 * gap. */
void connection_notify(connection *c, out_line *line) {
    server *s = c->server;
    if (c->closed || c->aborted || c->finishing)
        return;
    if (c->lost > 0 || line == NULL || !has_room_for_notice(c, line) || !queue(c, line)) {
        c->lost++;
        s->statistics.lost++;
    } else {
        s->statistics.notices++;
    }
}

out_line *connection_notice(enum sheard_notice notice, const sheard_notice_params *params) {
    sheard_rpc_error error;
    char *text = NULL;
    size_t n = 0;
    sheard_notice_line(&text, &n, notice, params, &error);
    return out_line_new(text, n);
}

void connection_tell_lost(connection *c) {
    if (c->lost == 0 || c->finishing || c->out.bytes > c->server->limits.queue_bytes / 16)
        return;
    const sheard_notice_params params = {.lost.count = (int64_t)c->lost};
    c->lost = 0;
    connection_send(c, connection_notice(SHEARD_NOTICE_LOST, &params));
}

void connection_send_error(connection *c, const sheard_rpc_id *id, const sheard_rpc_error *error) {
    static const sheard_rpc_id none = {.type = SHEARD_ID_NULL};
    const bool known = error->code > 0 && error->code < SHEARD_N_RPC_CODES;
    char *text = NULL;
    size_t n = 0;
    c->server->statistics.errors[known ? error->code : SHEARD_RPC_UNKNOWN]++;
    if (sheard_error_line(&text, &n, id != NULL ? id : &none, error) != SHEARD_RPC_OK) {
        text = strdup(sheard_rpc_no_memory_line);
        n = strlen(sheard_rpc_no_memory_line);
    }
    connection_send(c, out_line_new(text, n));
}

static void on_written(uv_write_t *write, int status) {
    connection *c = write->data;
    server *s = c->server;
    if (c->closed) {
        return; /* the queue is freed with the connection */
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
    if (c->out.n > 0)
        scheduler_flush_later(s, c);
    scheduler_add(s, c);
}

/* Collect the oldest lines into bufs[WRITE_LINES]. Return their number. */
static unsigned gather(const out_queue *q, uv_buf_t *bufs, size_t *bytes) {
    size_t skip = q->written;
    size_t n = 0;
    *bytes = 0;
    while (n < q->n && n < WRITE_LINES && *bytes < WRITE_BYTES) {
        const out_line *line = out_queue_at(q, n);
        bufs[n++] = (uv_buf_t){.base = line->bytes + skip, .len = line->n - skip};
        *bytes += line->n - skip;
        skip = 0;
    }
    return (unsigned)n;
}

/* Write what the socket takes now; libuv writes the rest when the socket takes more. */
void connection_write(connection *c) {
    uv_buf_t bufs[WRITE_LINES];
    size_t bytes;
    while (c->writing == 0 && c->out.n > 0 && !c->aborted) {
        unsigned n = gather(&c->out, bufs, &bytes);
        const int rc = uv_try_write((uv_stream_t *)&c->pipe, bufs, n);
        const size_t written = rc > 0 ? (size_t)rc : 0;
        c->server->statistics.bytes_out += written;
        wrote(c, written);
        if (written > 0)
            c->progress_ms = uv_now(c->server->loop);
        if (written == bytes)
            continue;
        n = gather(&c->out, bufs, &c->writing);
        c->write.data = c;
        if ((rc < 0 && rc != UV_EAGAIN) ||
            uv_write(&c->write, (uv_stream_t *)&c->pipe, bufs, n, on_written) != 0) {
            c->writing = 0;
            connection_abort(c);
        }
    }
}

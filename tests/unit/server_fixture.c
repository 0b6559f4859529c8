/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server_fixture.h"

#include "server/internal.h"
#include "test.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

/* ---- the owner ---- */

static void answer(fixture *f, server_handle handle) {
    char *text = malloc(f->reply_bytes + 1);
    assert_non_null(text);
    memset(text, 'x', f->reply_bytes);
    text[f->reply_bytes] = '\0';
    const sheard_reply reply = {.metrics = {.content_type = "text/plain", .text = text}};
    server_reply(f->s, handle, &reply);
    free(text);
}

static void on_request(void *context, const server_request *request) {
    fixture *f = context;
    f->peer_uid = request->peer->uid;
    f->peer_groups = request->peer->n_groups;
    if (f->n < FX_REQUESTS) {
        f->handles[f->n] = request->handle;
        f->methods[f->n++] = request->request->method;
    }
    const sheard_msg_subscribe *what = &request->request->params.subscribe;
    sheard_reply reply = {0};
    sheard_rpc_error error;
    int rc = SHEARD_RPC_OK;
    switch (request->request->method) {
    case SHEARD_METHOD_METRICS:
        if (!f->hold)
            answer(f, request->handle);
        break;
    case SHEARD_METHOD_SUBSCRIBE:
        rc = server_subscribe(f->s, request->handle.connection, what, &reply.subscribe, &error);
        break;
    case SHEARD_METHOD_UNSUBSCRIBE:
        rc = server_unsubscribe(f->s, request->handle.connection, what, &reply.unsubscribe, &error);
        break;
    default:
        break;
    }
    if (rc != SHEARD_RPC_OK) {
        server_reply_error(f->s, request->handle, &error);
    } else if (request->request->method == SHEARD_METHOD_SUBSCRIBE ||
               request->request->method == SHEARD_METHOD_UNSUBSCRIBE) {
        server_reply(f->s, request->handle, &reply);
    }
}

static void on_closed(void *context, uint64_t id) {
    fixture *f = context;
    if (f->n_closed < FX_REQUESTS)
        f->closed[f->n_closed++] = id;
}

static bool is_admin(void *context, const access_peer *peer) {
    (void)peer;
    return ((const fixture *)context)->admins;
}

static void on_done(void *context) {
    fixture *f = context;
    f->done = true;
    f->s = NULL;
}

void fx_init(fixture *f) {
    memset(f, 0, sizeof *f);
    snprintf(f->dir, sizeof f->dir, "/tmp/sheard-test-XXXXXX");
    assert_non_null(mkdtemp(f->dir));
    snprintf(f->path, sizeof f->path, "%s/socket", f->dir);
    assert_int_equal(uv_loop_init(&f->loop), 0);
    f->reply_bytes = 10;
    f->admins = true;
    f->options = (server_options){
        .path = f->path,
        .mode = 0660,
        .handlers = {
            .request = on_request, .closed = on_closed, .is_admin = is_admin, .context = f}};
    server_limits_init(&f->options.limits);
}

void fx_deinit(fixture *f) {
    FX_UNTIL(f, !uv_loop_alive(&f->loop));
    assert_int_equal(uv_loop_close(&f->loop), 0);
    unlink(f->path);
    assert_int_equal(rmdir(f->dir), 0); /* and so there is nothing else left */
}

void fx_open(fixture *f) {
    shear_error err = {0};
    f->done = false;
    if (server_open(&f->s, &f->loop, &f->options, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

void fx_close(fixture *f, int64_t flush_ms) {
    server_close(f->s, flush_ms, on_done, f);
    FX_UNTIL(f, f->done);
}

int fx_setup(void **state) {
    fixture *f = malloc(sizeof *f);
    assert_non_null(f);
    fx_init(f);
    *state = f;
    return 0;
}

int fx_teardown(void **state) {
    fixture *f = *state;
    if (f->s != NULL)
        fx_close(f, 0);
    fx_deinit(f);
    free(f);
    return 0;
}

void fx_turn(fixture *f) {
    uv_run(&f->loop, UV_RUN_NOWAIT);
}

bool fx_is_open(const fixture *f, server_handle handle) {
    const connection *c = connection_table_find(f->s, handle.connection);
    const open_request *r = c != NULL ? open_requests_find(&c->open, handle.request) : NULL;
    return r != NULL && !r->answered;
}

server_statistics fx_statistics(const fixture *f) {
    server_statistics statistics;
    server_get_statistics(f->s, &statistics);
    return statistics;
}

/* ---- clients ---- */

void cl_connect(const fixture *f, client *c) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    *c = (client){.fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    snprintf(address.sun_path, sizeof address.sun_path, "%s", f->path);
    assert_true(c->fd >= 0);
    assert_int_equal(connect(c->fd, (const struct sockaddr *)&address, sizeof address), 0);
}

void cl_close(client *c) {
    close(c->fd);
    free(c->text);
    *c = (client){.fd = -1};
}

size_t cl_push(client *c, const char *text, size_t n) {
    const ssize_t sent = send(c->fd, text, n, MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent > 0 ? (size_t)sent : 0;
}

void cl_send(fixture *f, client *c, const char *text, size_t n) {
    size_t sent = 0;
    FX_UNTIL(f, (sent += cl_push(c, text + sent, n - sent)) == n);
}

void cl_say(fixture *f, client *c, const char *text) {
    cl_send(f, c, text, strlen(text));
}

bool cl_has_line(client *c) {
    static char buf[1 << 16];
    while (!c->ended) {
        const ssize_t n = recv(c->fd, buf, sizeof buf, MSG_DONTWAIT);
        if (n <= 0) {
            c->ended = n == 0 || errno != EAGAIN; /* with unread bytes left: a reset */
            break;
        }
        c->text = realloc(c->text, c->n + (size_t)n);
        assert_non_null(c->text);
        memcpy(c->text + c->n, buf, (size_t)n);
        c->n += (size_t)n;
    }
    return c->n > 0 && memchr(c->text, '\n', c->n) != NULL;
}

sheard_message cl_next(fixture *f, client *c) {
    sheard_message message;
    sheard_rpc_error error;
    FX_UNTIL(f, cl_has_line(c) || c->ended);
    const char *end = c->n > 0 ? memchr(c->text, '\n', c->n) : NULL;
    if (end == NULL) {
        fail_msg("the server closed the connection");
        abort();
    }
    const size_t n = (size_t)(end - c->text);
    if (sheard_message_parse(&message, c->text, n, &error) != SHEARD_RPC_OK)
        fail_msg("%s: %.*s", error.message, (int)n, c->text);
    c->n -= n + 1;
    memmove(c->text, end + 1, c->n);
    return message;
}

int64_t cl_error(fixture *f, client *c, int code) {
    sheard_message m = cl_next(f, c);
    const int64_t id = m.id.type == SHEARD_ID_INTEGER ? m.id.integer : -1;
    assert_int_equal(m.kind, SHEARD_MESSAGE_ERROR);
    assert_string_equal(m.error.name, sheard_rpc_code_get(code)->name);
    sheard_message_deinit(&m);
    return id;
}

int64_t cl_reply(fixture *f, client *c) {
    sheard_message m = cl_next(f, c);
    if (m.kind != SHEARD_MESSAGE_REPLY)
        fail_msg("not a reply: %s", m.error.message);
    const int64_t id = m.id.integer;
    sheard_message_deinit(&m);
    return id;
}

int64_t cl_notice(fixture *f, client *c, int notice) {
    sheard_message m = cl_next(f, c);
    assert_int_equal(m.kind, SHEARD_MESSAGE_NOTICE);
    assert_int_equal(m.notice, notice);
    const int64_t number = notice == SHEARD_NOTICE_LOST           ? m.params.lost.count
                           : notice == SHEARD_NOTICE_JOB_PROGRESS ? m.params.job_progress.id
                                                                  : 0;
    sheard_message_deinit(&m);
    return number;
}

void cl_ended(fixture *f, client *c) {
    FX_UNTIL(f, cl_has_line(c) || c->ended);
    assert_int_equal(c->n, 0);
}

const char *request_text(int64_t id, const char *method, const char *params) {
    static char text[4096];
    snprintf(text, sizeof text,
             "{\"jsonrpc\":\"2.0\",\"id\":%" PRId64 ",\"method\":\"%s\",\"params\":%s}\n", id,
             method, params != NULL ? params : "{}");
    return text;
}

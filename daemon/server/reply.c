/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the owner sends: replies to one, notifications to many. */
#include "server/internal.h"

#include <stdlib.h>

/* The open request of a handle, and its connection; NULL: there is nobody to answer. */
static open_request *find(const server *s, server_handle handle, connection **c) {
    *c = server_find(s, handle.connection);
    open_request *r = *c != NULL ? open_requests_find(&(*c)->open, handle.request) : NULL;
    return r != NULL && !r->answered ? r : NULL;
}

bool server_is_open(const server *s, server_handle handle) {
    connection *c;
    return find(s, handle, &c) != NULL;
}

static void answered(connection *c, open_request *r) {
    server *s = c->server;
    if (r == s->in_step) {
        r->answered = true; /* removed when its step has ended */
        s->in_step = NULL;
    } else {
        if (r->awake) {
            turns_end_work(s, c);
        }
        open_requests_remove(&c->open, r->number);
    }
    c->active_ms = uv_now(c->server->loop);
    server_schedule(s, c); /* it may take the next request now */
}

void server_reply(server *s, server_handle to, const sheard_reply *reply) {
    connection *c;
    open_request *r = find(s, to, &c);
    sheard_rpc_error error;
    char *line;
    size_t n;
    if (r == NULL) {
        return;
    }
    if (sheard_reply_line(&line, &n, &r->id, r->method, reply, &error) == SHEARD_RPC_OK) {
        connection_send(c, out_text_new(line, n));
    } else {
        connection_send_error(c, &r->id, &error);
    }
    answered(c, r);
}

void server_reply_error(server *s, server_handle to, const sheard_rpc_error *error) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r != NULL) {
        connection_send_error(c, &r->id, error);
        answered(c, r);
    }
}

void server_reply_line(server *s, server_handle to, char *line, size_t n) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r == NULL) {
        free(line);
        return;
    }
    if (line != NULL) {
        connection_send(c, out_text_new(line, n));
    } else {
        sheard_rpc_error error;
        sheard_rpc_fail(&error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory for the reply");
        connection_send_error(c, &r->id, &error);
    }
    answered(c, r);
}

/* ---- work ---- */

bool server_defer(server *s, server_handle to, const server_work *work) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r == NULL) {
        work->drop(work->context);
        return false;
    }
    r->work = *work;
    open_requests_wake(&c->open, r);
    server_schedule(s, c);
    return true;
}

void server_wake(server *s, server_handle to) {
    connection *c;
    open_request *r = find(s, to, &c);
    if (r != NULL && r->work.step != NULL) {
        open_requests_wake(&c->open, r);
        server_schedule(s, c);
    }
}

/* ---- subscriptions ---- */

/* Keep the list of subscribers and `*now` in step with what c watches. */
static void note_change(connection *c, sheard_msg_subscribed *now) {
    server *s = c->server;
    const bool any = watched_anything(&c->watched);
    if (any && !c->subscribed) {
        TAILQ_INSERT_TAIL(&s->subscribers, c, subscriber_link);
        s->statistics.subscribers++;
    } else if (!any && c->subscribed) {
        TAILQ_REMOVE(&s->subscribers, c, subscriber_link);
        s->statistics.subscribers--;
    }
    c->subscribed = any;
    server_schedule(s, c); /* without subscriptions it may be over */
    if (now != NULL) {
        *now = (sheard_msg_subscribed){.jobs = (int64_t)c->watched.n_jobs,
                                       .fields = (int64_t)c->watched.n_fields,
                                       .all = c->watched.all};
    }
}

static int is_gone(sheard_rpc_error *error) {
    return sheard_rpc_fail(error, SHEARD_RPC_STOPPING, NULL, "the connection is gone");
}

int server_subscribe(server *s, uint64_t connection_id, const sheard_msg_subscribe *what,
                     sheard_msg_subscribed *now, sheard_rpc_error *error) {
    connection *c = server_find(s, connection_id);
    if (c == NULL) {
        return is_gone(error);
    }
    const int rc = watched_add(&c->watched, what, s->limits.subscriptions, error);
    if (rc == SHEARD_RPC_OK) {
        note_change(c, now);
    }
    return rc;
}

int server_unsubscribe(server *s, uint64_t connection_id, const sheard_msg_subscribe *what,
                       sheard_msg_subscribed *now, sheard_rpc_error *error) {
    connection *c = server_find(s, connection_id);
    if (c == NULL) {
        return is_gone(error);
    }
    watched_remove(&c->watched, what);
    note_change(c, now);
    return SHEARD_RPC_OK;
}

bool server_is_watched(const server *s, int notice, int64_t job, const char *field) {
    const connection *c;
    TAILQ_FOREACH(c, &s->subscribers, subscriber_link) {
        if (watched_matches(&c->watched, notice, job, field)) {
            return true;
        }
    }
    return false;
}

void server_publish(server *s, int notice, int64_t job, const char *field,
                    const sheard_notice_params *params) {
    out_text *text = NULL;
    bool made = false;
    connection *c;
    TAILQ_FOREACH(c, &s->subscribers, subscriber_link) {
        if (!watched_matches(&c->watched, notice, job, field)) {
            continue;
        }
        if (!made) {
            sheard_rpc_error error;
            char *line;
            size_t n;
            sheard_notice_line(&line, &n, notice, params, &error);
            text = out_text_new(line, n);
            made = true;
            if (text != NULL) {
                out_text_count(text, &s->notice_bytes);
            }
        }
        connection_notify(c, text);
    }
    out_text_drop(text);
}

void server_end_job(server *s, int64_t job) {
    connection *next;
    for (connection *c = TAILQ_FIRST(&s->subscribers); c; c = next) {
        next = TAILQ_NEXT(c, subscriber_link);
        if (watched_end_job(&c->watched, job)) {
            note_change(c, NULL);
        }
    }
}

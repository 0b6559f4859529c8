/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manage subscriptions, and send the notifications that they select. */
#include "base/cleanup.h"
#include "server/internal.h"

/* Update the list of subscribers and *now after a change of the subscriptions of c. */
static void note_change(connection *c, sheard_msg_subscribed *now) {
    server *s = c->server;
    const bool any = subscriptions_any(&c->subscriptions);
    if (any && !c->subscribed) {
        TAILQ_INSERT_TAIL(&s->subscribers, c, subscriber_link);
        s->statistics.subscribers++;
    } else if (!any && c->subscribed) {
        TAILQ_REMOVE(&s->subscribers, c, subscriber_link);
        s->statistics.subscribers--;
    }
    c->subscribed = any;
    scheduler_add(s, c); /* without subscriptions the connection may be over */
    if (now != NULL) {
        *now = (sheard_msg_subscribed){.jobs = (int64_t)c->subscriptions.n_jobs,
                                       .fields =
                                           (int64_t)(c->subscriptions.n - c->subscriptions.n_jobs),
                                       .all = c->subscriptions.all};
    }
}

static int is_gone(sheard_rpc_error *error) {
    return sheard_rpc_fail(error, SHEARD_RPC_STOPPING, NULL, "the connection is gone");
}

int server_subscribe(server *s, uint64_t connection_id, const sheard_msg_subscribe *what,
                     sheard_msg_subscribed *now, sheard_rpc_error *error) {
    connection *c = connection_table_find(s, connection_id);
    if (c == NULL)
        return is_gone(error);
    TRY(subscriptions_add(&c->subscriptions, what, s->limits.subscriptions, error));
    note_change(c, now);
    return SHEARD_RPC_OK;
}

int server_unsubscribe(server *s, uint64_t connection_id, const sheard_msg_subscribe *what,
                       sheard_msg_subscribed *now, sheard_rpc_error *error) {
    connection *c = connection_table_find(s, connection_id);
    if (c == NULL)
        return is_gone(error);
    subscriptions_remove(&c->subscriptions, what);
    note_change(c, now);
    return SHEARD_RPC_OK;
}

bool server_is_watched(const server *s, enum sheard_notice notice, int64_t job, const char *field) {
    const connection *c;
    TAILQ_FOREACH(c, &s->subscribers, subscriber_link) {
        if (subscriptions_match(&c->subscriptions, notice, job, field))
            return true;
    }
    return false;
}

void server_publish(server *s, enum sheard_notice notice, int64_t job, const char *field,
                    const sheard_notice_params *params) {
    if (!server_is_watched(s, notice, job, field))
        return;
    out_line *line = connection_notice(notice, params);
    if (line != NULL)
        out_line_count(line, &s->notice_bytes);
    connection *c;
    TAILQ_FOREACH(c, &s->subscribers, subscriber_link) {
        if (subscriptions_match(&c->subscriptions, notice, job, field))
            connection_notify(c, line);
    }
    out_line_unref(line);
}

void server_end_job(server *s, int64_t job) {
    connection *next;
    for (connection *c = TAILQ_FIRST(&s->subscribers); c != NULL; c = next) {
        next = TAILQ_NEXT(c, subscriber_link);
        if (subscriptions_end_job(&c->subscriptions, job))
            note_change(c, NULL);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/internal.h: the server's state, for its own files only. */
#pragma once

#include "server/connection.h"
#include "server/connection_table.h"
#include "server/scheduler.h"
#include "server/server.h"
#include "server/socket_file.h"

enum { SERVER_MAX_LISTENERS = 16, SERVER_READ_BYTES = 16384 };

/* Reasons for refusing a client. */
enum refusal { REFUSAL_ALL_CONNECTIONS, REFUSAL_USER_CONNECTIONS, N_REFUSALS };

struct server {
    uv_loop_t *loop;
    server_handlers handlers;
    server_limits limits;
    shear_settings defaults;
    bool has_defaults;

    socket_file file;
    uv_pipe_t listeners[SERVER_MAX_LISTENERS];
    size_t n_listeners;
    bool accepting;
    bool starved; /* memory ran out while accepting a client: try again at the next tick */
    char *refusals[N_REFUSALS]; /* error replies, as lines */
    size_t refusal_bytes[N_REFUSALS];

    connection_table table;
    scheduler scheduler;
    open_request *in_step;          /* whose step is running and not answered yet, or NULL */
    connection_list subscribers;    /* connections with subscriptions */
    size_t notice_bytes;            /* bytes of notifications that some client has not read */
    uv_timer_t tick;                /* closes idle and stalled connections */
    char buffer[SERVER_READ_BYTES]; /* input of the connection being read, until the callback
                                       returns */
    server_statistics statistics;

    bool closing;
    uv_timer_t deadline;
    size_t handles; /* libuv handles not closed yet: the server is freed after the last one */
    void (*done)(void *context);
    void *done_context;
};

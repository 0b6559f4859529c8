/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/internal.h: the server as its own files see it. */
#ifndef SHEARD_SERVER_INTERNAL_H
#define SHEARD_SERVER_INTERNAL_H

#include "server/connection.h"
#include "server/connection_table.h"
#include "server/scheduler.h"
#include "server/server.h"
#include "server/socket_file.h"

enum { SERVER_MAX_LISTENERS = 16, SERVER_READ_BYTES = 16384 };

/* Why a client is not let in. */
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
    bool starved;               /* a client could not be accepted for want of memory: try again */
    char *refusals[N_REFUSALS]; /* lines */
    size_t refusal_bytes[N_REFUSALS];

    connection_table table;
    scheduler scheduler;
    open_request *in_step;          /* whose work is in a step; NULL once it is answered */
    connection_list subscribers;    /* those with subscriptions */
    size_t notice_bytes;            /* of notifications that somebody has not read */
    uv_timer_t tick;                /* looks for the silent and the stalled */
    char buffer[SERVER_READ_BYTES]; /* what is being read, until the callback returns */
    server_statistics statistics;

    bool closing;
    uv_timer_t deadline;
    size_t handles; /* libuv's handles that are not closed yet; the memory is theirs till then */
    void (*done)(void *context);
    void *done_context;
};

#endif

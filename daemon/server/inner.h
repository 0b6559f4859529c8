/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server as its own files see it. */
#ifndef SERVER_INNER_H
#define SERVER_INNER_H

#include "server/connection.h"
#include "server/server.h"
#include "server/socket.h"

enum { SERVER_MAX_LISTENERS = 16, SERVER_SCRATCH = 65536 };

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
    bool starved; /* a client could not be accepted for want of memory: try again */
    char *refusal;
    size_t refusal_bytes;

    connection **slots; /* [n_slots] NULL: free; a connection's number tells its slot */
    size_t n_slots;
    size_t *free_slots; /* [n_free] of [n_slots] */
    size_t n_free;
    uint64_t serial;
    size_t n_work;
    connection_list work;         /* those with something to do in the next turn */
    connection_list subscribers;  /* those that watch something */
    uv_idle_t turn;               /* runs while there is work */
    uv_timer_t tick;              /* looks for the silent and the stalled */
    char scratch[SERVER_SCRATCH]; /* what is being read, until the callback returns */
    server_statistics statistics;

    bool closing;
    uv_timer_t deadline;
    size_t handles; /* libuv's handles that are not closed yet; the memory is theirs till then */
    void (*done)(void *context);
    void *done_context;
};

/* A handle of the server, or of a connection, has been closed. The last one frees the server. */
void server_handle_gone(server *s);

/* The connection of that number; NULL: gone. */
connection *server_find(const server *s, uint64_t id);
/* Give the connection a slot and a number. False: out of memory. */
bool server_enter(server *s, connection *c);
/* It is closed: take it out of every list, and tell the owner. */
void server_leave(server *s, connection *c);
/* It has something to do. */
void server_schedule(server *s, connection *c);

#endif

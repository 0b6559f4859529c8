/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server as its own files see it. */
#ifndef SERVER_INNER_H
#define SERVER_INNER_H

#include "server/connection.h"
#include "server/server.h"
#include "server/socket_file.h"
#include "server/users.h"

enum { SERVER_MAX_LISTENERS = 16, SERVER_SCRATCH = 16384 };

enum { SERVER_ALL_CONNECTIONS, SERVER_USER_CONNECTIONS, SERVER_N_REFUSALS };

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
    bool starved;   /* a client could not be accepted for want of memory: try again */
    size_t accepts; /* clients that may be accepted before the next turn */
    bool more_wait; /* there were more than that */
    char *refusal[SERVER_N_REFUSALS]; /* lines */
    size_t refusal_bytes[SERVER_N_REFUSALS];

    connection **slots; /* [n_slots] NULL: free; a connection's number tells its slot */
    size_t n_slots;
    size_t *free_slots; /* [n_free] of [n_slots] */
    size_t n_free;
    uint64_t serial;
    server_user_list users;
    uint64_t clock_ns;            /* see users_next */
    connection *current;          /* the one that has its turn, */
    bool again;                   /* ... and wants another */
    open_request *in_step;        /* whose work is in a step; NULL once it is answered */
    connection_list unflushed;    /* with lines to write */
    connection_list subscribers;  /* those that watch something */
    size_t notice_bytes;          /* of notifications that somebody has not read */
    bool room_wanted;             /* work waits for bytes to be read */
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
/* Accept those that wait. */
void server_accept(server *s);

/* ---- turns.c ---- */

void turns_init(server *s);
/* It has something to do. */
void server_schedule(server *s, connection *c);
/* It has something to write. */
void turns_flush_later(server *s, connection *c);
/* It is closed: out of the lists. */
void turns_leave(server *s, connection *c);
/* Do replies that are not sent take all the memory that they (or the user's) may? */
bool turns_is_crowded(const server *s, const server_user *u);
/* May the connection's work be done now? Else it is told when it may. */
bool turns_may_work(server *s, connection *c);
/* Its work is done, pauses, or cannot go on now: it is another connection's turn. */
void turns_end_work(server *s, connection *c);
/* Fewer bytes are unsent. */
void turns_made_room(server *s);
/* May a client be accepted now? Else it is in a later turn. */
bool turns_may_accept(server *s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/scheduler.h: decide which connection is next, and for how long. */
#pragma once

#include "server/users.h"

/* The functions that the scheduler calls. */
typedef struct scheduler_calls {
    void (*process)(connection *c); /* do one request, or one step of deferred work */
    void (*flush)(connection *c);   /* write what is queued */
    void (*accept)(server *s);      /* accept the clients that wait */
} scheduler_calls;

typedef struct scheduler {
    scheduler_calls call;
    server_user_list users;
    uint64_t clock_ns;         /* virtual time of the users: users_next */
    connection *current;       /* the connection being processed, */
    bool again;                /* ... and whether it has more to do */
    connection_list unflushed; /* connections with lines to write */
    bool work_waits;           /* deferred work waits for unsent bytes to be written */
    size_t accepts;            /* clients that may still be accepted in this slice */
    bool more_clients;         /* clients wait beyond that number */
    uv_idle_t idle;            /* runs while there is something to do */
} scheduler;

void scheduler_init(server *s, scheduler_calls call);
/* Mark the connection as ready. */
void scheduler_add(server *s, connection *c);
/* Have the connection's queue written later. */
void scheduler_flush_later(server *s, connection *c);
/* Remove a closed connection from the lists. */
void scheduler_remove(server *s, connection *c);
/* Return whether unsent replies exceed the limit of all users together or of this one. */
bool scheduler_is_crowded(const server *s, const server_user *u);
/* Return whether the connection may do deferred work now. If not, it becomes ready when it may. */
bool scheduler_may_work(server *s, connection *c);
/* Let another connection of the user do deferred work: this one's is done, paused or blocked. */
void scheduler_end_work(server *s, connection *c);
/* Resume deferred work if enough bytes have been written. */
void scheduler_note_freed(server *s);
/* Return whether a client may be accepted now. If not, `accept` is called in a later slice. */
bool scheduler_may_accept(server *s);

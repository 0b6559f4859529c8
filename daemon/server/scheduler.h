/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/scheduler.h: which connection is next, and for how long. */
#ifndef SHEARD_SERVER_SCHEDULER_H
#define SHEARD_SERVER_SCHEDULER_H

#include "server/users.h"

/* What the scheduler has others do. */
typedef struct scheduler_calls {
    void (*process)(connection *c); /* one request, or one step of the work of one */
    void (*flush)(connection *c);   /* write what is queued */
    void (*accept)(server *s);      /* the clients that wait */
} scheduler_calls;

typedef struct scheduler {
    scheduler_calls call;
    server_user_list users;
    uint64_t clock_ns;         /* see users_next */
    connection *current;       /* the one that is being processed, */
    bool again;                /* ... and has more to do */
    connection_list unflushed; /* with lines to write */
    bool work_waits;           /* for bytes to be read */
    size_t accepts;            /* clients that may be accepted before the next slice */
    bool more_clients;         /* there were more than that */
    uv_idle_t idle;            /* runs while there is something to do */
} scheduler;

void scheduler_init(server *s, scheduler_calls call);
/* It has something to do. */
void scheduler_add(server *s, connection *c);
/* It has something to write. */
void scheduler_flush_later(server *s, connection *c);
/* It is closed: out of the lists. */
void scheduler_remove(server *s, connection *c);
/* Do replies that are not sent take all the memory that they (or the user's) may? */
bool scheduler_is_crowded(const server *s, const server_user *u);
/* May the connection's deferred work be done now? Else it is told when it may. */
bool scheduler_may_work(server *s, connection *c);
/* Its work is done, pauses, or cannot go on now: another connection of the user may work. */
void scheduler_end_work(server *s, connection *c);
/* Fewer bytes are unsent. */
void scheduler_note_freed(server *s);
/* May a client be accepted now? Else it is in a later slice. */
bool scheduler_may_accept(server *s);

#endif

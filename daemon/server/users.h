/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/users.h: the accounts of processor time by which the scheduler chooses. Of the users that
 * have something to do, the one charged with the least time is next, then the user's connection
 * with the least. An idle user saves up at most USERS_CREDIT_NS. */
#pragma once

#include "server/connection.h"

/* Processor time that an idle user or connection may be behind the others. */
enum { USERS_CREDIT_NS = 1000000 };

typedef struct server_user server_user;
struct server_user {
    TAILQ_ENTRY(server_user) link; /* in the list of all users */
    uid_t uid;
    size_t references;  /* connections, including those being closed */
    size_t connections; /* open connections */
    uint64_t used_ns;   /* processor time charged to the user */
    uint64_t clock_ns;  /* virtual time of its connections: the used_ns of the one served last */
    connection **ready; /* [n] of [capacity], a heap with the least used_ns on top */
    size_t n, capacity;
    connection_list deferred; /* connections with deferred work, in order of arrival */
    connection *at_work;      /* the connection whose deferred work is being done, or NULL */
    size_t held;              /* bytes of unsent replies */
};
typedef TAILQ_HEAD(server_user_list, server_user) server_user_list;

/* Return the user of a uid, with one more reference, or NULL if out of memory. The heap then has
 * capacity for all of the user's connections. `clock_ns` is the server's: see users_next. */
server_user *users_join(server_user_list *all, uid_t uid, uint64_t clock_ns);
/* Give up a reference. The last one frees the user. */
void users_part(server_user_list *all, server_user *u);

/* Add a connection that has something to do. */
void users_add_ready(server_user *u, connection *c, uint64_t clock_ns);
/* Remove a ready connection from the heap. */
void users_remove_ready(server_user *u, connection *c);
/* Remove the next connection from its user's heap and return it, or NULL if none is ready.
 * *clock_ns is advanced to its user's time. */
connection *users_next(server_user_list *all, uint64_t *clock_ns);
/* Charge processor time to a connection, which must not be ready, and to its user. */
void users_charge(connection *c, uint64_t ns);

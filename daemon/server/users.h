/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/users.h: users, and which of them is next. Of those that have something to do, the one
 * that has had the least time is next: users first, then the user's connections. Time that somebody
 * did not ask for is not saved up, but for USERS_CREDIT_NS. */
#ifndef SERVER_USERS_H
#define SERVER_USERS_H

#include "server/connection.h"

/* So much work may somebody who was quiet ask for before the others come first. */
enum { USERS_CREDIT_NS = 1000000 };

typedef struct server_user server_user;
struct server_user {
    TAILQ_ENTRY(server_user) link; /* of all users */
    uid_t uid;
    size_t references;  /* connections, those that are being closed too */
    size_t connections; /* that are open */
    uint64_t used_ns;   /* time that it has had */
    uint64_t clock_ns;  /* ... and, the least of its connections' that are ready */
    connection **ready; /* [n] of [capacity], a heap: the one with the least time on top */
    size_t n, capacity;
    connection_list deferred; /* whose deferred work waits, in the order of coming */
    connection *at_work;      /* the one whose work is being done */
    size_t held;              /* memory of replies that are not sent */
};
typedef TAILQ_HEAD(server_user_list, server_user) server_user_list;

/* The record of a uid, with a reference for a connection more; NULL: out of memory. It has
 * capacity for all of the user's connections to be ready. `clock_ns`: the server's, see users_next.
 */
server_user *users_join(server_user_list *all, uid_t uid, uint64_t clock_ns);
void users_part(server_user_list *all, server_user *u);

/* The connection is ready. */
void users_add_ready(server_user *u, connection *c, uint64_t clock_ns);
void users_remove_ready(server_user *u, connection *c);
/* The connection that is next, out of its user's heap; NULL: nobody is ready. Moves *clock_ns on.
 */
connection *users_next(server_user_list *all, uint64_t *clock_ns);
/* It has had so much time. Not while it is ready. */
void users_charge(connection *c, uint64_t ns);

#endif

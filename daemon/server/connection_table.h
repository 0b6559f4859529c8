/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection_table.h: the open connections, by number. */
#pragma once

#include "server/connection.h"

typedef struct connection_table {
    connection **items; /* [n] of [capacity], in ascending order of number */
    size_t n, capacity;
    uint64_t last; /* last number given out */
} connection_table;

/* Return the connection of that number, or NULL if it is gone. */
connection *connection_table_find(const server *s, uint64_t id);
/* Give the connection a number. Return false if out of memory. */
bool connection_table_enter(server *s, connection *c);
/* Remove a closed connection from every list, and notify the owner. */
void connection_table_leave(server *s, connection *c);
/* Call the function for every open connection, the newest first. It may close the connection. */
void connection_table_each(server *s, void (*call)(connection *c));

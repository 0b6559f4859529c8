/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection_table.h: the open connections by number. */
#ifndef SHEARD_SERVER_CONNECTION_TABLE_H
#define SHEARD_SERVER_CONNECTION_TABLE_H

#include "server/connection.h"

/* A connection's number: its serial number and, in the low bits, its slot. */
enum { CONNECTION_SLOT_BITS = 20, CONNECTION_SLOTS = 1 << CONNECTION_SLOT_BITS };

typedef struct connection_table {
    connection **slots; /* [n_slots] NULL: free */
    size_t n_slots, capacity;
    size_t *free_slots; /* [n_free] of [free_capacity], which holds n_slots at least */
    size_t n_free, free_capacity;
    uint64_t serial;
} connection_table;

/* The connection of that number; NULL: gone. */
connection *connection_table_find(const server *s, uint64_t id);
/* Give the connection a slot and a number. False: out of memory. */
bool connection_table_enter(server *s, connection *c);
/* It is closed: take it out of every list, and tell the owner. */
void connection_table_leave(server *s, connection *c);
/* Call it for every open connection, which it may close. */
void connection_table_each(server *s, void (*call)(connection *c));

#endif

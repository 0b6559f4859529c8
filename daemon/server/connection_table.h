/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection_table.h: the open connections, by number. */
#pragma once

#include "server/connection.h"

/* A connection's number holds a serial number and, in the low bits, its slot. */
enum { CONNECTION_SLOT_BITS = 20, CONNECTION_SLOTS = 1 << CONNECTION_SLOT_BITS };

typedef struct connection_table {
    connection **slots; /* [n_slots] NULL: free */
    size_t n_slots, capacity;
    size_t *free_slots; /* [n_free] of [free_capacity]; free_capacity is at least n_slots */
    size_t n_free, free_capacity;
    uint64_t serial;
} connection_table;

/* Return the connection of that number, or NULL if it is gone. */
connection *connection_table_find(const server *s, uint64_t id);
/* Give the connection a slot and a number. Return false if out of memory or slots. */
bool connection_table_enter(server *s, connection *c);
/* Remove a closed connection from every list, and notify the owner. */
void connection_table_leave(server *s, connection *c);
/* Call the function for every open connection. It may close the connection. */
void connection_table_each(server *s, void (*call)(connection *c));

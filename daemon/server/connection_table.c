/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/connection_table.h"

#include "base/array.h"
#include "server/internal.h"

#include <assert.h>

connection *connection_table_find(const server *s, uint64_t id) {
    const size_t slot = id % CONNECTION_SLOTS;
    connection *c = slot < s->table.n_slots ? s->table.slots[slot] : NULL;
    return c != NULL && c->id == id ? c : NULL;
}

static bool acquire_slot(connection_table *t, size_t *slot) {
    if (t->n_free > 0) {
        *slot = t->free_slots[--t->n_free];
        return true;
    }
    if (t->n_slots == CONNECTION_SLOTS || !ARRAY_RESERVE(t->slots, t->capacity, t->n_slots + 1) ||
        !ARRAY_RESERVE(t->free_slots, t->free_capacity, t->n_slots + 1)) {
        return false;
    }
    *slot = t->n_slots++;
    return true;
}

bool connection_table_enter(server *s, connection *c) {
    size_t slot = 0;
    if (!acquire_slot(&s->table, &slot))
        return false;
    s->table.slots[slot] = c;
    c->id = ++s->table.serial * CONNECTION_SLOTS + slot;
    s->statistics.connections++;
    c->user->connections++;
    return true;
}

void connection_table_leave(server *s, connection *c) {
    connection_table *t = &s->table;
    const size_t slot = c->id % CONNECTION_SLOTS;
    assert(t->slots[slot] == c && t->n_free < t->free_capacity);
    t->slots[slot] = NULL;
    t->free_slots[t->n_free++] = slot;
    s->statistics.connections--;
    c->user->connections--;
    scheduler_remove(s, c);
    if (c->subscribed) {
        TAILQ_REMOVE(&s->subscribers, c, subscriber_link);
        c->subscribed = false;
        s->statistics.subscribers--;
    }
    if (s->handlers.closed != NULL)
        s->handlers.closed(s->handlers.context, c->id);
}

void connection_table_each(server *s, void (*call)(connection *c)) {
    for (size_t i = 0; i < s->table.n_slots; i++) {
        if (s->table.slots[i] != NULL)
            call(s->table.slots[i]);
    }
}

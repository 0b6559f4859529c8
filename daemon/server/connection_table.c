/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/connection_table.h"

#include "base/array.h"
#include "server/internal.h"

#include <assert.h>
#include <string.h>

static int by_id(const void *id, const void *item) {
    const uint64_t a = *(const uint64_t *)id;
    const uint64_t b = (*(connection *const *)item)->id;
    return (a > b) - (a < b);
}

/* Return the index of the first connection whose number is not below `id`. */
static size_t search(const connection_table *t, uint64_t id) {
    return array_lower_bound(t->items, t->n, sizeof(connection *), &id, by_id);
}

connection *connection_table_find(const server *s, uint64_t id) {
    const connection_table *t = &s->table;
    const size_t i = search(t, id);
    return i < t->n && t->items[i]->id == id ? t->items[i] : NULL;
}

bool connection_table_enter(server *s, connection *c) {
    connection_table *t = &s->table;
    if (!ARRAY_RESERVE(t->items, t->capacity, t->n + 1))
        return false;
    c->id = ++t->last;
    t->items[t->n++] = c;
    s->statistics.connections++;
    c->user->connections++;
    return true;
}

void connection_table_leave(server *s, connection *c) {
    connection_table *t = &s->table;
    const size_t i = search(t, c->id);
    assert(t->items[i] == c);
    t->n--;
    memmove(&t->items[i], &t->items[i + 1], (t->n - i) * sizeof(connection *));
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
    for (size_t i = s->table.n; i > 0; i--)
        call(s->table.items[i - 1]);
}

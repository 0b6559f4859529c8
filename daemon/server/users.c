/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/users.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>

/* ---- users ---- */

static server_user *find(server_user_list *all, uid_t uid) {
    server_user *u = TAILQ_FIRST(all);
    while (u != NULL && u->uid != uid)
        u = TAILQ_NEXT(u, link);
    return u;
}

static void drop_unused(server_user_list *all, server_user *u) {
    if (u->references == 0) {
        TAILQ_REMOVE(all, u, link);
        free(u->ready);
        free(u);
    }
}

server_user *users_join(server_user_list *all, uid_t uid, uint64_t clock_ns) {
    server_user *u = find(all, uid);
    if (u == NULL) {
        u = calloc(1, sizeof *u);
        if (u == NULL)
            return NULL;
        u->uid = uid;
        u->used_ns = clock_ns; /* a new user has saved up no time */
        TAILQ_INIT(&u->deferred);
        TAILQ_INSERT_TAIL(all, u, link);
    }
    if (!ARRAY_RESERVE(u->ready, u->capacity, u->references + 1)) {
        drop_unused(all, u);
        return NULL;
    }
    u->references++;
    return u;
}

void users_part(server_user_list *all, server_user *u) {
    assert(u->references > 0);
    u->references--;
    drop_unused(all, u);
}

/* ---- the heap: places begin at 1; 0 means not in the heap ---- */

static void put(server_user *u, size_t place, connection *c) {
    u->ready[place - 1] = c;
    c->place = place;
}

static void move_up(server_user *u, size_t place, connection *c) {
    while (place > 1 && u->ready[place / 2 - 1]->used_ns > c->used_ns) {
        put(u, place, u->ready[place / 2 - 1]);
        place /= 2;
    }
    put(u, place, c);
}

static void move_down(server_user *u, size_t place, connection *c) {
    for (size_t child = 2 * place; child <= u->n; child = 2 * place) {
        if (child < u->n && u->ready[child]->used_ns < u->ready[child - 1]->used_ns)
            child++;
        if (u->ready[child - 1]->used_ns >= c->used_ns)
            break;
        put(u, place, u->ready[child - 1]);
        place = child;
    }
    put(u, place, c);
}

void users_remove_ready(server_user *u, connection *c) {
    const size_t place = c->place;
    assert(place > 0 && place <= u->n && u->ready[place - 1] == c);
    connection *last = u->ready[--u->n];
    c->place = 0;
    if (last != c) {
        move_down(u, place, last);
        move_up(u, last->place, last);
    }
}

/* ---- order ---- */

static uint64_t not_before(uint64_t used_ns, uint64_t clock_ns) {
    const uint64_t least = clock_ns > USERS_CREDIT_NS ? clock_ns - USERS_CREDIT_NS : 0;
    return used_ns > least ? used_ns : least;
}

void users_add_ready(server_user *u, connection *c, uint64_t clock_ns) {
    assert(c->place == 0 && u->n < u->capacity);
    if (u->n == 0)
        u->used_ns = not_before(u->used_ns, clock_ns);
    c->used_ns = not_before(c->used_ns, u->clock_ns);
    move_up(u, ++u->n, c);
}

connection *users_next(server_user_list *all, uint64_t *clock_ns) {
    server_user *next = NULL;
    server_user *u;
    TAILQ_FOREACH(u, all, link) {
        if (u->n > 0 && (next == NULL || u->used_ns < next->used_ns))
            next = u;
    }
    if (next == NULL)
        return NULL;
    connection *c = next->ready[0];
    *clock_ns = next->used_ns > *clock_ns ? next->used_ns : *clock_ns;
    next->clock_ns = c->used_ns > next->clock_ns ? c->used_ns : next->clock_ns;
    users_remove_ready(next, c);
    return c;
}

void users_charge(connection *c, uint64_t ns) {
    assert(c->place == 0);
    c->used_ns += ns;
    c->user->used_ns += ns;
}

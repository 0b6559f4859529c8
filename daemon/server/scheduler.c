/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose turn it is, and for how long. */
#include "server/internal.h"

#include <time.h>

enum { ACCEPTS = 32 /* in a turn */ };

static void on_turn(uv_idle_t *idle);

static void keep_turning(server *s) {
    uv_idle_start(&s->turn, on_turn);
}

void server_schedule(server *s, connection *c) {
    if (c->closed) {
        return;
    }
    if (c == s->current) {
        s->again = true;
    } else if (c->place == 0) {
        users_add_ready(c->user, c, s->clock_ns);
    }
    keep_turning(s);
}

void turns_flush_later(server *s, connection *c) {
    if (!c->unflushed && !c->closed) {
        c->unflushed = true;
        TAILQ_INSERT_TAIL(&s->unflushed, c, unflushed_link);
        keep_turning(s);
    }
}

static void no_flush(server *s, connection *c) {
    if (c->unflushed) {
        c->unflushed = false;
        TAILQ_REMOVE(&s->unflushed, c, unflushed_link);
    }
}

void turns_leave(server *s, connection *c) {
    no_flush(s, c);
    if (c->place != 0) {
        users_remove_ready(c->user, c);
    }
    turns_end_work(s, c);
}

/* ---- work, and room for its results ---- */

bool turns_is_crowded(const server *s, const server_user *u) {
    return s->statistics.unsent_bytes > s->limits.unsent_bytes ||
           u->held > s->limits.unsent_bytes / 2;
}

static void no_heavy(connection *c) {
    if (c->in_heavy) {
        c->in_heavy = false;
        TAILQ_REMOVE(&c->user->heavy, c, heavy_link);
    }
}

static void offer_work(server *s, const server_user *u) {
    if (u->at_work == NULL && !TAILQ_EMPTY(&u->heavy)) {
        server_schedule(s, TAILQ_FIRST(&u->heavy));
    }
}

bool turns_may_work(server *s, connection *c) {
    server_user *u = c->user;
    if (u->at_work == c) {
        return true;
    }
    if (!c->in_heavy) {
        c->in_heavy = true;
        TAILQ_INSERT_TAIL(&u->heavy, c, heavy_link);
    }
    if (u->at_work != NULL || TAILQ_FIRST(&u->heavy) != c) {
        return false;
    }
    if (turns_is_crowded(s, u)) {
        s->room_wanted = true;
        return false;
    }
    no_heavy(c);
    u->at_work = c;
    return true;
}

void turns_end_work(server *s, connection *c) {
    server_user *u = c->user;
    no_heavy(c);
    u->at_work = u->at_work == c ? NULL : u->at_work;
    offer_work(s, u);
}

void turns_made_room(server *s) {
    if (s->room_wanted && s->statistics.unsent_bytes <= s->limits.unsent_bytes) {
        const server_user *u;
        s->room_wanted = false;
        TAILQ_FOREACH(u, &s->users, link) {
            offer_work(s, u);
        }
    }
}

/* ---- turns ---- */

static void flush_some(server *s, uint64_t end) {
    while (!TAILQ_EMPTY(&s->unflushed) && uv_hrtime() < end) {
        connection *c = TAILQ_FIRST(&s->unflushed);
        no_flush(s, c);
        connection_flush(c);
    }
}

/* What the thread has worked: nobody is charged for the machine's other work. */
static uint64_t worked_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
}

/* One thing for each, in the order that users_next says, until the time is over. */
static void serve(server *s, uint64_t end) {
    uint64_t now = worked_ns();
    do {
        connection *c = users_next(&s->users, &s->clock_ns);
        if (c == NULL) {
            return;
        }
        const uint64_t begin = now;
        s->current = c;
        s->again = false;
        connection_turn(c);
        if (!s->again && c->unflushed) { /* whoever asked for one thing has it at once */
            no_flush(s, c);
            connection_flush(c);
        }
        s->current = NULL;
        now = worked_ns();
        users_charge(c, now - begin);
        if (s->again) {
            server_schedule(s, c);
        }
    } while (uv_hrtime() < end);
}

static bool anybody_is_ready(const server *s) {
    const server_user *u = TAILQ_FIRST(&s->users);
    while (u != NULL && u->n == 0) {
        u = TAILQ_NEXT(u, link);
    }
    return u != NULL;
}

static void on_turn(uv_idle_t *idle) {
    server *s = idle->data;
    const uint64_t turn_ns = (uint64_t)s->limits.slice_us * 1000;
    serve(s, uv_hrtime() + turn_ns);
    flush_some(s, uv_hrtime() + turn_ns);
    s->accepts = ACCEPTS;
    if (s->more_wait) {
        s->more_wait = false;
        server_accept(s);
    }
    if (!anybody_is_ready(s) && TAILQ_EMPTY(&s->unflushed) && !s->more_wait) {
        uv_idle_stop(&s->turn);
    }
}

/* The listener's callback: accept it now, or in a later turn. */
bool turns_may_accept(server *s) {
    if (s->accepts == 0) {
        s->more_wait = true;
        keep_turning(s);
        return false;
    }
    s->accepts--;
    return true;
}

void turns_init(server *s) {
    TAILQ_INIT(&s->users);
    TAILQ_INIT(&s->unflushed);
    s->accepts = ACCEPTS;
}

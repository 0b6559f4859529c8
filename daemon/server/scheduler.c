/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/scheduler.h"

#include "base/clock.h"
#include "server/internal.h"

#include <assert.h>

enum { ACCEPTS = 32 /* per slice */ };

static void run_slice(uv_idle_t *idle);

static void keep_running(server *s) {
    uv_idle_start(&s->scheduler.idle, run_slice);
}

void scheduler_add(server *s, connection *c) {
    if (c->closed)
        return;
    if (c == s->scheduler.current) {
        s->scheduler.again = true;
    } else if (c->place == 0) {
        users_add_ready(c->user, c, s->scheduler.clock_ns);
    }
    keep_running(s);
}

void scheduler_flush_later(server *s, connection *c) {
    if (!c->unflushed && !c->closed) {
        c->unflushed = true;
        TAILQ_INSERT_TAIL(&s->scheduler.unflushed, c, unflushed_link);
        keep_running(s);
    }
}

static void leave_unflushed(server *s, connection *c) {
    if (c->unflushed) {
        c->unflushed = false;
        TAILQ_REMOVE(&s->scheduler.unflushed, c, unflushed_link);
    }
}

void scheduler_remove(server *s, connection *c) {
    leave_unflushed(s, c);
    if (c->place != 0)
        users_remove_ready(c->user, c);
    scheduler_end_work(s, c);
}

/* ---- deferred work, and memory for its results ---- */

bool scheduler_is_crowded(const server *s, const server_user *u) {
    return s->statistics.unsent_bytes > s->limits.unsent_bytes ||
           u->held > s->limits.unsent_bytes / 2;
}

static void leave_deferred(connection *c) {
    if (c->in_deferred) {
        c->in_deferred = false;
        TAILQ_REMOVE(&c->user->deferred, c, deferred_link);
    }
}

static void offer_work(server *s, const server_user *u) {
    if (u->at_work == NULL && !TAILQ_EMPTY(&u->deferred))
        scheduler_add(s, TAILQ_FIRST(&u->deferred));
}

bool scheduler_may_work(server *s, connection *c) {
    server_user *u = c->user;
    if (u->at_work == c)
        return true;
    if (!c->in_deferred) {
        c->in_deferred = true;
        TAILQ_INSERT_TAIL(&u->deferred, c, deferred_link);
    }
    if (u->at_work != NULL || TAILQ_FIRST(&u->deferred) != c)
        return false;
    if (scheduler_is_crowded(s, u)) {
        s->scheduler.work_waits = true;
        return false;
    }
    leave_deferred(c);
    u->at_work = c;
    return true;
}

void scheduler_end_work(server *s, connection *c) {
    server_user *u = c->user;
    leave_deferred(c);
    u->at_work = u->at_work == c ? NULL : u->at_work;
    offer_work(s, u);
}

void scheduler_note_freed(server *s) {
    if (s->scheduler.work_waits && s->statistics.unsent_bytes <= s->limits.unsent_bytes) {
        const server_user *u;
        s->scheduler.work_waits = false;
        TAILQ_FOREACH(u, &s->scheduler.users, link) {
            offer_work(s, u);
        }
    }
}

/* ---- slices ---- */

static void flush_some(server *s, uint64_t end) {
    while (!TAILQ_EMPTY(&s->scheduler.unflushed) && uv_hrtime() < end) {
        connection *c = TAILQ_FIRST(&s->scheduler.unflushed);
        leave_unflushed(s, c);
        s->scheduler.call.flush(c);
    }
}

/* Process ready connections, in the order of users_next, until the time is up. */
static void serve(server *s, uint64_t end) {
    /* This is the thread's own processor time: nobody is charged for other work of the machine. */
    int64_t now = clock_ns(CLOCK_THREAD_CPUTIME_ID);
    do {
        connection *c = users_next(&s->scheduler.users, &s->scheduler.clock_ns);
        if (c == NULL)
            return;
        const int64_t begin = now;
        assert(!c->closed);
        s->scheduler.current = c;
        s->scheduler.again = false;
        s->scheduler.call.process(c);
        if (!s->scheduler.again && c->unflushed) { /* write the reply to a single request at once */
            leave_unflushed(s, c);
            s->scheduler.call.flush(c);
        }
        s->scheduler.current = NULL;
        now = clock_ns(CLOCK_THREAD_CPUTIME_ID);
        users_charge(c, (uint64_t)(now - begin));
        if (s->scheduler.again)
            scheduler_add(s, c);
    } while (uv_hrtime() < end);
}

static bool anybody_is_ready(const server *s) {
    const server_user *u = TAILQ_FIRST(&s->scheduler.users);
    while (u != NULL && u->n == 0)
        u = TAILQ_NEXT(u, link);
    return u != NULL;
}

static void run_slice(uv_idle_t *idle) {
    server *s = idle->data;
    const uint64_t slice_ns = (uint64_t)s->limits.slice_us * 1000;
    serve(s, uv_hrtime() + slice_ns);
    flush_some(s, uv_hrtime() + slice_ns);
    s->scheduler.accepts = ACCEPTS;
    if (s->scheduler.more_clients) {
        s->scheduler.more_clients = false;
        s->scheduler.call.accept(s);
    }
    if (!anybody_is_ready(s) && TAILQ_EMPTY(&s->scheduler.unflushed) &&
        !s->scheduler.more_clients) {
        uv_idle_stop(&s->scheduler.idle);
    }
}

bool scheduler_may_accept(server *s) {
    if (s->scheduler.accepts == 0) {
        s->scheduler.more_clients = true;
        keep_running(s);
        return false;
    }
    s->scheduler.accepts--;
    return true;
}

void scheduler_init(server *s, scheduler_calls call) {
    scheduler *d = &s->scheduler;
    d->call = call;
    TAILQ_INIT(&d->users);
    TAILQ_INIT(&d->unflushed);
    d->accepts = ACCEPTS;
    uv_idle_init(s->loop, &d->idle);
    d->idle.data = s;
    s->handles++;
}

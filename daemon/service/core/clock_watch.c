/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time: what is told and stored is the wall clock's; what is waited for is measured by a clock that
 * nobody sets. */
#include "service/inner.h"

#include <stdlib.h>
#include <time.h>

/* Less is the way clocks are corrected all the time: slowly. */
static const int64_t jump_ms = 1000;
/* A clock that was set forward is believed, for what is removed because of its age, when it has
 * stood so long. */
static const int64_t believed_ms = INT64_C(24) * 3600 * 1000;

static int64_t clock_ms(clockid_t id) {
    struct timespec t;
    clock_gettime(id, &t);
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

int64_t wall_ms(void) {
    return clock_ms(CLOCK_REALTIME);
}

int64_t steady_ms(void) {
    return clock_ms(CLOCK_BOOTTIME);
}

static int64_t latest_ms(const service *s, int64_t wall) {
    return wall + s->config.retry.max_delay_ms;
}

int clock_start(service *s, shear_error *err) {
    const int64_t wall = wall_ms();
    const int64_t steady = steady_ms();
    const store_clock clock = {.latest_ms = latest_ms(s, wall), .now_ms = wall};
    s->clock = (service_clock){
        .offset_ms = wall - steady, .aged_offset_ms = wall - steady, .jumped_ms = steady};
    return store_set_clock(s->store, &clock, err);
}

/* The group with the moved jobs is on disk, or it is to be done again. */
static void moved(service *s, after *a, int code, const shear_error *err) {
    (void)err;
    s->clock.owed_ms += code == SHEAR_OK ? 0 : a->job;
}

static void move_waiting(service *s, int64_t wall) {
    shear_error err = {0};
    const int64_t delta = s->clock.owed_ms;
    const store_clock clock = {.delta_ms = delta, .latest_ms = latest_ms(s, wall), .now_ms = wall};
    if (group_begin(s, &err) != SHEAR_OK) {
        return;
    }
    after *a = group_after(s, moved);
    if (a != NULL && store_set_clock(s->store, &clock, &err) == SHEAR_OK) {
        s->clock.owed_ms = 0;
        a->job = delta;
    }
}

static void follow(service_clock *c, int64_t offset, int64_t steady, int64_t by) {
    const bool jumped = by >= jump_ms || by <= -jump_ms;
    if (jumped) {
        log_notice("the clock was set %s by %.1f s: waiting jobs wait as long as they were to",
                   by < 0 ? "back" : "forward", 1e-3 * (double)(by < 0 ? -by : by));
        c->owed_ms += by;
        c->jumped_ms = steady;
    } else {
        c->aged_offset_ms += by;
    }
    if (offset < c->aged_offset_ms || steady - c->jumped_ms >= believed_ms) {
        c->aged_offset_ms = offset;
    }
    c->offset_ms = offset;
}

void clock_look(service *s) {
    const int64_t wall = wall_ms();
    const int64_t steady = steady_ms();
    follow(&s->clock, wall - steady, steady, wall - steady - s->clock.offset_ms);
    if (s->clock.owed_ms != 0 && s->store_trouble_ms == 0) {
        move_waiting(s, wall);
    }
}

int64_t clock_for_ages(const service *s) {
    return steady_ms() + s->clock.aged_offset_ms;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/clock_watch.h"

#include "log/log.h"
#include "service/core/clock.h"

/* Smaller steps are gradual corrections of the clock. */
static const int64_t jump_ms = 1000;
/* How long a clock that was set forward must have run before ages are computed from it. */
static const int64_t believed_ms = INT64_C(24) * 3600 * 1000;

static int64_t latest_ms(const clock_watch *w, int64_t wall) {
    return wall + w->config->retry.max_delay_ms;
}

int clock_watch_start(clock_watch *w, group *g, const sheard_config *config, shear_error *err) {
    const int64_t wall = clock_wall_ms();
    const int64_t steady = clock_steady_ms();
    *w = (clock_watch){.group = g,
                       .config = config,
                       .offset_ms = wall - steady,
                       .aged_offset_ms = wall - steady,
                       .jumped_ms = steady};
    const store_clock clock = {.latest_ms = latest_ms(w, wall), .now_ms = wall};
    return store_set_clock(g->store, &clock, err);
}

typedef struct clock_move {
    post_commit post; /* first */
    clock_watch *watch;
    int64_t delta_ms;
} clock_move;

/* Keep the delta for another try if the group with the moved jobs is not on disk. */
static void moved(post_commit *post, int code, const shear_error *err) {
    const clock_move *move = (const clock_move *)post;
    (void)err;
    move->watch->owed_ms += code == SHEAR_OK ? 0 : move->delta_ms;
}

static void move_waiting(clock_watch *w, int64_t wall) {
    shear_error err = {0};
    const store_clock clock = {
        .delta_ms = w->owed_ms, .latest_ms = latest_ms(w, wall), .now_ms = wall};
    if (group_begin(w->group, &err) != SHEAR_OK)
        return;
    clock_move *move = group_then(w->group, moved, 0, sizeof *move);
    if (move == NULL)
        return;
    move->watch = w;
    if (store_set_clock(w->group->store, &clock, &err) == SHEAR_OK) {
        move->delta_ms = clock.delta_ms;
        w->owed_ms = 0;
    }
}

static void follow(clock_watch *w, int64_t offset, int64_t steady) {
    const int64_t by = offset - w->offset_ms;
    const bool jumped = by >= jump_ms || by <= -jump_ms;
    if (jumped) {
        log_notice("the clock was set %s by %.1f s: waiting jobs wait as long as planned",
                   by < 0 ? "back" : "forward", 1e-3 * (double)(by < 0 ? -by : by));
        w->owed_ms += by;
        w->jumped_ms = steady;
    } else {
        w->aged_offset_ms += by;
    }
    if (offset < w->aged_offset_ms || steady - w->jumped_ms >= believed_ms)
        w->aged_offset_ms = offset;
    w->offset_ms = offset;
}

void clock_watch_look(clock_watch *w) {
    const int64_t wall = clock_wall_ms();
    const int64_t steady = clock_steady_ms();
    follow(w, wall - steady, steady);
    if (w->owed_ms != 0 && !w->group->failing)
        move_waiting(w, wall);
}

int64_t clock_watch_for_ages(const clock_watch *w) {
    return clock_steady_ms() + w->aged_offset_ms;
}

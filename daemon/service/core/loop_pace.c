/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/loop_pace.h"

#include "base/clock.h"

/* Before the loop waits: from one of these to the next is a turn. */
static void on_turn_begins(uv_prepare_t *handle) {
    loop_pace *p = handle->data;
    const int64_t now = clock_ns(CLOCK_THREAD_CPUTIME_ID);
    const int64_t turn = p->marked_ns != 0 ? now - p->marked_ns : 0;
    int64_t *lately = &p->longest_at[p->second % PACE_SLOTS];
    p->marked_ns = now;
    p->longest_ns = turn > p->longest_ns ? turn : p->longest_ns;
    *lately = turn > *lately ? turn : *lately;
}

void loop_pace_start(loop_pace *p, uv_loop_t *loop) {
    uv_prepare_init(loop, &p->turn_begins);
    p->turn_begins.data = p;
    uv_prepare_start(&p->turn_begins, on_turn_begins);
}

void loop_pace_tick(loop_pace *p) {
    p->second++;
    p->longest_at[p->second % PACE_SLOTS] = 0;
}

int64_t loop_pace_last_minute_ns(const loop_pace *p) {
    int64_t longest = 0;
    for (int i = 0; i < PACE_SLOTS; i++) {
        longest = p->longest_at[i] > longest ? p->longest_at[i] : longest;
    }
    return longest;
}

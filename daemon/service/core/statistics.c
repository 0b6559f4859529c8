/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/statistics.h"

#include "base/clock.h"

/* Called before the loop waits for events; the time between two calls is one turn. */
static void on_turn_begins(uv_prepare_t *handle) {
    statistics *st = handle->data;
    const int64_t now = clock_ns(CLOCK_THREAD_CPUTIME_ID);
    const int64_t turn = st->begun_ns != 0 ? now - st->begun_ns : 0;
    int64_t *lately = &st->longest_at[st->ticks % STATISTICS_SLOTS];
    st->begun_ns = now;
    st->longest_turn_ns = turn > st->longest_turn_ns ? turn : st->longest_turn_ns;
    *lately = turn > *lately ? turn : *lately;
}

void statistics_start(statistics *st, uv_loop_t *loop) {
    uv_prepare_init(loop, &st->turn_begins);
    st->turn_begins.data = st;
    uv_prepare_start(&st->turn_begins, on_turn_begins);
}

void statistics_tick(statistics *st, int64_t stamps, int64_t jobs) {
    st->ticks++;
    st->stamps_at[st->ticks % STATISTICS_SLOTS] = stamps;
    st->jobs_at[st->ticks % STATISTICS_SLOTS] = jobs;
    st->longest_at[st->ticks % STATISTICS_SLOTS] = 0;
}

sheard_msg_rates statistics_rates(const statistics *st) {
    const int64_t span = st->ticks < STATISTICS_SLOTS - 1 ? st->ticks : STATISTICS_SLOTS - 1;
    if (span <= 0)
        return (sheard_msg_rates){0};
    const int64_t now = st->ticks % STATISTICS_SLOTS;
    const int64_t then = (st->ticks - span) % STATISTICS_SLOTS;
    return (sheard_msg_rates){
        .stamps_per_s = (double)(st->stamps_at[now] - st->stamps_at[then]) / (double)span,
        .jobs_per_s = (double)(st->jobs_at[now] - st->jobs_at[then]) / (double)span};
}

int64_t statistics_longest_turn_ns(const statistics *st) {
    int64_t longest = 0;
    for (int i = 0; i < STATISTICS_SLOTS; i++)
        longest = st->longest_at[i] > longest ? st->longest_at[i] : longest;
    return longest;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/rates.h"

void rates_tick(rates *r, int64_t stamps, int64_t jobs) {
    r->ticks++;
    r->stamps_at[r->ticks % RATE_SLOTS] = stamps;
    r->jobs_at[r->ticks % RATE_SLOTS] = jobs;
}

sheard_msg_rates rates_get(const rates *r) {
    const int64_t span = r->ticks < RATE_SLOTS - 1 ? r->ticks : RATE_SLOTS - 1;
    if (span <= 0) {
        return (sheard_msg_rates){0};
    }
    const int64_t now = r->ticks % RATE_SLOTS;
    const int64_t then = (r->ticks - span) % RATE_SLOTS;
    return (sheard_msg_rates){
        .stamps_per_s = (double)(r->stamps_at[now] - r->stamps_at[then]) / (double)span,
        .jobs_per_s = (double)(r->jobs_at[now] - r->jobs_at[then]) / (double)span};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/statistics.h: rates of the last minute, and the longest turn of the loop, for which
 * all clients wait. Turns are measured in processor time of the loop's thread, which does not
 * depend on the machine's other work or on a slow disk. */
#pragma once

#include "sheard/messages.h"

#include <uv.h>

enum { STATISTICS_SLOTS = 61 }; /* ring of the last minute's seconds */

typedef struct statistics {
    int64_t ticks; /* seconds since the start */
    int64_t stamps_at[STATISTICS_SLOTS], jobs_at[STATISTICS_SLOTS];
    uv_prepare_t turn_begins;
    int64_t begun_ns;        /* when this turn began; 0: there was none yet */
    int64_t longest_turn_ns; /* since the start */
    int64_t longest_at[STATISTICS_SLOTS];
} statistics;

void statistics_start(statistics *st, uv_loop_t *loop);
/* Record the numbers of stamps measured and jobs ended since the start. Call once a second. */
void statistics_tick(statistics *st, int64_t stamps, int64_t jobs);
/* Return the rates over the last minute, or since the start if that is shorter. */
sheard_msg_rates statistics_rates(const statistics *st);
int64_t statistics_longest_turn_ns(const statistics *st); /* of the last minute */

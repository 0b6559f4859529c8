/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/statistics.h: how much was done in the last minute, and how long a turn of the loop
 * takes: everybody waits for it. In processor time of the loop's thread, so that it tells of the
 * service and not of the machine's other work, nor of a slow disk. */
#ifndef SHEARD_SERVICE_STATISTICS_H
#define SHEARD_SERVICE_STATISTICS_H

#include "sheard/messages.h"

#include <uv.h>

enum { STATISTICS_SLOTS = 61 }; /* a ring of the last minute's seconds */

typedef struct statistics {
    int64_t ticks; /* seconds since the start */
    int64_t stamps_at[STATISTICS_SLOTS], jobs_at[STATISTICS_SLOTS];
    uv_prepare_t turn_begins;
    int64_t begun_ns;        /* the turn; 0: there was none yet */
    int64_t longest_turn_ns; /* since the start */
    int64_t longest_at[STATISTICS_SLOTS];
} statistics;

void statistics_start(statistics *st, uv_loop_t *loop);
/* Once a second: stamps measured and jobs ended since the start. */
void statistics_tick(statistics *st, int64_t stamps, int64_t jobs);
/* Over the last minute, or since the start where that is shorter. */
sheard_msg_rates statistics_rates(const statistics *st);
int64_t statistics_longest_turn_ns(const statistics *st); /* of the last minute */

#endif

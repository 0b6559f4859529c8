/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/loop_pace.h: how long a turn of the loop takes: everybody waits for it. In processor
 * time of the loop's thread, so that it tells of the service and not of the machine's other work,
 * nor of a slow disk. */
#ifndef SHEARD_SERVICE_LOOP_PACE_H
#define SHEARD_SERVICE_LOOP_PACE_H

#include <stdint.h>
#include <uv.h>

enum { PACE_SLOTS = 61 }; /* a ring of the last minute's seconds */

typedef struct loop_pace {
    uv_prepare_t turn_begins;
    int64_t marked_ns;  /* the turn began; 0: there was none yet */
    int64_t longest_ns; /* since the start */
    int64_t longest_at[PACE_SLOTS];
    int64_t second;
} loop_pace;

void loop_pace_start(loop_pace *p, uv_loop_t *loop);
void loop_pace_tick(loop_pace *p); /* once a second */
int64_t loop_pace_last_minute_ns(const loop_pace *p);

#endif

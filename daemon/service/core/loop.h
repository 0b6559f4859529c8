/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/loop.h: what wakes the loop up, besides clients and files: signals, the tick of each
 * second, the engine. */
#ifndef SHEARD_SERVICE_LOOP_H
#define SHEARD_SERVICE_LOOP_H

#include <uv.h>

typedef struct service service;

enum { LOOP_SIGNALS = 3 };

typedef struct loop_events {
    uv_async_t engine; /* any thread may send it */
    uv_signal_t signals[LOOP_SIGNALS];
    uv_timer_t tick;
} loop_events;

void loop_start(service *s);

#endif

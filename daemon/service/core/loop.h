/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/loop.h: the loop's events other than clients and files: signals, a tick every
 * second, the engine. */
#pragma once

#include <uv.h>

typedef struct service service;

enum { LOOP_SIGNALS = 3 };

typedef struct loop_events {
    uv_async_t engine; /* uv_async_send may be called from any thread */
    uv_signal_t signals[LOOP_SIGNALS];
    uv_timer_t tick;
} loop_events;

void loop_start(service *s);

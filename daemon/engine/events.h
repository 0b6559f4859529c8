/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/events.h: the engine's events on their way to the owner, first in, first out. Thread-safe.
 */
#ifndef SHEARD_ENGINE_EVENTS_H
#define SHEARD_ENGINE_EVENTS_H

#include "engine/engine.h"

#include <pthread.h>

typedef struct queued_event queued_event;

typedef struct events {
    pthread_mutex_t lock;
    queued_event *first, **last;
} events;

void events_init(events *q);
void events_deinit(events *q); /* drops what is left */

/* Take *event over. `ending`: the thread, soon to end, whose last event this is, or NULL; it is
 * joined when the event is taken out. */
void events_push(events *q, const engine_event *event, const pthread_t *ending);
bool events_pop(events *q, engine_event *event);

#endif

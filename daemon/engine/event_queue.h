/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/event_queue.h: the engine's events on their way to the owner, first in, first out.
 * Thread-safe. */
#ifndef SHEARD_ENGINE_EVENT_QUEUE_H
#define SHEARD_ENGINE_EVENT_QUEUE_H

#include "engine/engine.h"

#include <pthread.h>

typedef struct queued_event queued_event;

typedef struct event_queue {
    pthread_mutex_t lock;
    queued_event *first, **last;
    bool silent;
    void (*wake)(void *context); /* tells the owner, from any thread, that there is an event */
    void *context;
} event_queue;

void event_queue_init(event_queue *q, void (*wake)(void *context), void *context);
void event_queue_deinit(event_queue *q); /* drops what is left */
/* Wake the owner no more. */
void event_queue_silence(event_queue *q);

/* Take *event over. `last_of`: the thread whose last event this is, or NULL; it is joined when the
 * event is taken out. */
void event_queue_push(event_queue *q, const engine_event *event, const pthread_t *last_of);
/* False where there is none. */
bool event_queue_pop(event_queue *q, engine_event *event);

#endif

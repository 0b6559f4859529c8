/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/event_queue.h: the queue of events from the engine to its owner, first in, first out.
 * Thread-safe. */
#pragma once

#include "engine/engine.h"

#include <pthread.h>
#include <sys/queue.h>

typedef struct queued_event queued_event;

typedef struct event_queue {
    pthread_mutex_t lock;
    STAILQ_HEAD(, queued_event) list;
    bool silent;
    void (*wake)(void *context); /* notifies the owner of a new event; called from any thread */
    void *context;
} event_queue;

void event_queue_init(event_queue *q, void (*wake)(void *context), void *context);
void event_queue_deinit(event_queue *q); /* drops the events left */
/* Stop calling `wake`. */
void event_queue_silence(event_queue *q);

/* Queue *event and take over its memory. `last_of` is the thread of which this is the last event,
 * or NULL; the thread is joined when the event is taken out. */
void event_queue_push(event_queue *q, const engine_event *event, const pthread_t *last_of);
/* Take the next event. Return false if there is none. */
bool event_queue_pop(event_queue *q, engine_event *event);

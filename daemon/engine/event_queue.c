/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/event_queue.h"

#include "base/thread.h"

#include <stdlib.h>
#include <unistd.h>

struct queued_event {
    STAILQ_ENTRY(queued_event) link;
    engine_event event;
    bool is_last; /* the last event of `thread` */
    pthread_t thread;
};

void engine_event_deinit(engine_event *event) {
    free(event->sums);
    free(event->terms);
    event->sums = NULL;
    event->terms = NULL;
}

void event_queue_init(event_queue *q, void (*wake)(void *context), void *context) {
    *q = (event_queue){.wake = wake, .context = context};
    STAILQ_INIT(&q->list);
    pthread_mutex_init(&q->lock, NULL);
}

void event_queue_deinit(event_queue *q) {
    engine_event event;
    while (event_queue_pop(q, &event))
        engine_event_deinit(&event);
    pthread_mutex_destroy(&q->lock);
}

void event_queue_silence(event_queue *q) {
    LOCKED(&q->lock);
    q->silent = true;
}

/* Allocate an entry. If memory is out, wait for some: no event may be lost. */
static queued_event *allocate(void) {
    enum { PAUSE_US = 10000 };
    queued_event *one = malloc(sizeof *one);
    while (one == NULL) {
        usleep(PAUSE_US);
        one = malloc(sizeof *one);
    }
    return one;
}

void event_queue_push(event_queue *q, const engine_event *event, const pthread_t *last_of) {
    queued_event *one = allocate();
    *one = (queued_event){.event = *event, .is_last = last_of != NULL};
    if (last_of != NULL)
        one->thread = *last_of;
    pthread_mutex_lock(&q->lock);
    STAILQ_INSERT_TAIL(&q->list, one, link);
    const bool silent = q->silent;
    pthread_mutex_unlock(&q->lock);
    if (!silent)
        q->wake(q->context);
}

static queued_event *take_first(event_queue *q) {
    LOCKED(&q->lock);
    queued_event *one = STAILQ_FIRST(&q->list);
    if (one != NULL)
        STAILQ_REMOVE_HEAD(&q->list, link);
    return one;
}

bool event_queue_pop(event_queue *q, engine_event *event) {
    queued_event *one = take_first(q);
    if (one == NULL)
        return false;
    if (one->is_last)
        pthread_join(one->thread, NULL);
    *event = one->event;
    free(one);
    return true;
}

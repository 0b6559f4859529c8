/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/events.h"

#include <stdlib.h>
#include <unistd.h>

struct queued_event {
    queued_event *next;
    engine_event event;
    bool last; /* of `thread` */
    pthread_t thread;
};

void engine_event_deinit(engine_event *event) {
    free(event->sums);
    free(event->terms);
    event->sums = NULL;
    event->terms = NULL;
}

void events_init(events *q) {
    q->first = NULL;
    q->last = &q->first;
    pthread_mutex_init(&q->lock, NULL);
}

void events_deinit(events *q) {
    engine_event event;
    while (events_pop(q, &event)) {
        engine_event_deinit(&event);
    }
    pthread_mutex_destroy(&q->lock);
}

/* Where memory is out there is nothing better than to wait for some: events must not be lost. */
void events_push(events *q, const engine_event *event, const pthread_t *ending) {
    queued_event *one = malloc(sizeof *one);
    while (one == NULL) {
        usleep(10000);
        one = malloc(sizeof *one);
    }
    *one = (queued_event){.event = *event, .last = ending != NULL};
    if (ending != NULL) {
        one->thread = *ending;
    }
    pthread_mutex_lock(&q->lock);
    *q->last = one;
    q->last = &one->next;
    pthread_mutex_unlock(&q->lock);
}

bool events_pop(events *q, engine_event *event) {
    pthread_mutex_lock(&q->lock);
    queued_event *one = q->first;
    if (one != NULL) {
        q->first = one->next;
        if (q->first == NULL) {
            q->last = &q->first;
        }
    }
    pthread_mutex_unlock(&q->lock);
    if (one == NULL) {
        return false;
    }
    if (one->last) {
        pthread_join(one->thread, NULL);
    }
    *event = one->event;
    free(one);
    return true;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/unacknowledged.h"

#include <stdlib.h>
#include <string.h>

void unacknowledged_init(unacknowledged *o) {
    TAILQ_INIT(&o->pending);
    TAILQ_INIT(&o->refused);
    o->unsynced = false;
}

void unacknowledged_deinit(unacknowledged *o) {
    unacknowledged_retry(o);
    for (unacknowledged_file *one = unacknowledged_next(o); one != NULL;
         one = unacknowledged_next(o)) {
        free(one);
    }
}

bool unacknowledged_add(unacknowledged *o, const char *active_name, bool again, bool refused) {
    const size_t size = strlen(active_name) + 1;
    unacknowledged_file *one = malloc(sizeof *one + size);
    if (one == NULL)
        return false;
    one->again = again;
    memcpy(one->active_name, active_name, size);
    if (refused) {
        TAILQ_INSERT_TAIL(&o->refused, one, link);
    } else {
        TAILQ_INSERT_TAIL(&o->pending, one, link);
    }
    return true;
}

static void remove_from(struct unacknowledged_queue *queue, const char *active_name) {
    unacknowledged_file *one = NULL;
    TAILQ_FOREACH(one, queue, link) {
        if (strcmp(one->active_name, active_name) == 0) {
            TAILQ_REMOVE(queue, one, link);
            free(one);
            return;
        }
    }
}

void unacknowledged_remove(unacknowledged *o, const char *active_name) {
    remove_from(&o->pending, active_name);
    remove_from(&o->refused, active_name);
}

void unacknowledged_retry(unacknowledged *o) {
    TAILQ_CONCAT(&o->pending, &o->refused, link);
}

unacknowledged_file *unacknowledged_next(unacknowledged *o) {
    unacknowledged_file *one = TAILQ_FIRST(&o->pending);
    if (one != NULL)
        TAILQ_REMOVE(&o->pending, one, link);
    return one;
}

bool unacknowledged_pending(const unacknowledged *o) {
    return !TAILQ_EMPTY(&o->pending);
}

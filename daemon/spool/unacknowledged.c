/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/unacknowledged.h"

#include "spool/internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

void offers_init(offers *o) {
    TAILQ_INIT(&o->pending);
    TAILQ_INIT(&o->refused);
    o->unsynced = false;
}

void offers_deinit(offers *o) {
    offer *one = NULL;
    offers_revive(o);
    while ((one = TAILQ_FIRST(&o->pending)) != NULL) {
        TAILQ_REMOVE(&o->pending, one, link);
        free(one);
    }
}

bool offers_add(offers *o, const char *active_name, bool again, bool refused) {
    const size_t size = strlen(active_name) + 1;
    offer *one = malloc(sizeof *one + size);
    if (one == NULL) {
        return false;
    }
    one->again = again;

    memcpy(one->active_name, active_name, size);
    if (refused) {
        TAILQ_INSERT_TAIL(&o->refused, one, link);
    } else {
        TAILQ_INSERT_TAIL(&o->pending, one, link);
    }
    return true;
}

static void drop_from(struct offer_queue *queue, const char *active_name) {
    offer *one = NULL;
    TAILQ_FOREACH(one, queue, link) {
        if (strcmp(one->active_name, active_name) == 0) {
            TAILQ_REMOVE(queue, one, link);
            free(one);
            return;
        }
    }
}

void offers_drop(offers *o, const char *active_name) {
    drop_from(&o->pending, active_name);
    drop_from(&o->refused, active_name);
}

void offers_revive(offers *o) {
    TAILQ_CONCAT(&o->pending, &o->refused, link);
}

bool offers_pending(const offers *o) {
    return !TAILQ_EMPTY(&o->pending);
}

static void tell(spool *s, const char *active_name, bool again) {
    char key[SPOOL_KEY_SIZE];
    struct stat st;
    const int error = folder_stat(&s->folders, ACTIVE, active_name, &st);
    if (error == ENOENT) {
        spool_log(s, SPOOL_WARNING, "active/%s: vanished before it was looked at", active_name);
        s->stats.active--;
        return;
    }
    name_key(key, active_name);
    s->call.found(s->call.context, &(spool_file){active_name, key, name_of_active(active_name),
                                                 error == 0 ? st.st_uid : (uid_t)-1, again});
}

/* What the owner hears of is on disk, in this order: the new name, then the old one's end. */
static bool sync_moves(spool *s) {
    int error = folder_sync(&s->folders, ACTIVE);
    if (error == 0) {
        error = folder_sync(&s->folders, INCOMING);
    }
    if (error != 0) {
        spool_log(s, SPOOL_ERROR, "%s: cannot be brought to disk, tried again later: %s",
                  s->folders.path, strerror(error));
    }
    s->offers.unsynced = error != 0;
    return error == 0;
}

bool offers_tell(spool *s) {
    if (!offers_pending(&s->offers) || (s->offers.unsynced && !sync_moves(s))) {
        return false;
    }
    for (int i = 0; i < SPOOL_STEP_FILES && !s->closed && offers_pending(&s->offers); i++) {
        /* Out of the queue first: the owner may refuse it at once, or end it. */
        offer *one = TAILQ_FIRST(&s->offers.pending);
        TAILQ_REMOVE(&s->offers.pending, one, link);
        tell(s, one->active_name, one->again);
        free(one);
    }
    return !s->closed && offers_pending(&s->offers);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files in active/ that the owner has not accepted yet. */
#ifndef SHEARD_SPOOL_OFFERS_H
#define SHEARD_SPOOL_OFFERS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/queue.h>

typedef struct offer {
    TAILQ_ENTRY(offer) link;
    bool again; /* not for the first time */
    char active_name[];
} offer;
TAILQ_HEAD(offer_queue, offer);

typedef struct offers {
    struct offer_queue pending;
    struct offer_queue refused; /* not before the next scan */
    bool unsynced;              /* files were moved to active/ since the last fsync */
} offers;

void offers_init(offers *o);
void offers_deinit(offers *o);
/* False: out of memory. */
bool offers_add(offers *o, const char *active_name, bool again, bool refused);
void offers_drop(offers *o, const char *active_name);
void offers_revive(offers *o); /* those that were refused */
bool offers_pending(const offers *o);

#endif

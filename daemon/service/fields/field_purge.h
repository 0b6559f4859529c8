/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_purge.h: what was counted in forgotten fields leaves, a few milliseconds of
 * it in a group, for there may be very much; each contribution takes its job's catalog along. The
 * store keeps what is left to do: whoever waits for it may go, and the service, too. */
#ifndef SHEARD_SERVICE_FIELD_PURGE_H
#define SHEARD_SERVICE_FIELD_PURGE_H

#include "store/store.h"

#include <sys/queue.h>

typedef struct service service;

/* Whoever has forgotten a field and waits until all of it has left: first member of a record that
 * free() releases. */
typedef struct purge_waiter {
    TAILQ_ENTRY(purge_waiter) link;
    store_forgotten numbers;
    int64_t jobs; /* retracted so far */
    /* All of it has left, on disk. Nothing of the record is used afterwards. */
    void (*done)(service *s, struct purge_waiter *w);
} purge_waiter;

typedef struct field_purge {
    TAILQ_HEAD(, purge_waiter) waiters;
    bool under_way; /* this group has contributions that leave */
} field_purge;

void field_purge_init(field_purge *p);
void field_purge_deinit(field_purge *p); /* and those that wait */

/* Takes the record over. */
void field_purge_wait(service *s, purge_waiter *w);
/* Where something is left, it may be from before the start: some of it leaves with this group, and
 * the rest after it. Where that fails, it is tried with the next call, once a second. */
void field_purge_continue(service *s);

#endif

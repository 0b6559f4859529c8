/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_purge.h: remove the contributions of forgotten fields, a few milliseconds'
 * worth per group, since there may be very many. Each contribution takes its job's catalog along.
 * The list of what is left is in the store, and so survives clients and restarts. */
#pragma once

#include "store/store.h"

#include <sys/queue.h>

typedef struct service service;

/* A request that waits until all of a forgotten field is removed: the first member of a record,
 * malloc'd, that the purge owns. */
typedef struct purge_waiter {
    TAILQ_ENTRY(purge_waiter) link;
    store_forgotten numbers;
    int64_t jobs; /* retracted so far */
    /* Called when all of it is removed, on disk. The callee takes ownership of the record. */
    void (*done)(service *s, struct purge_waiter *w);
} purge_waiter;

typedef struct field_purge {
    TAILQ_HEAD(, purge_waiter) waiters;
    bool under_way; /* this group removes contributions */
} field_purge;

void field_purge_init(field_purge *p);
void field_purge_deinit(field_purge *p); /* and frees the waiters */

/* Add a waiter and take ownership of it. */
void field_purge_wait(service *s, purge_waiter *w);
/* Remove some of what is left, which may be from before the start, in this group; the next groups
 * continue. After a failure the next call tries again; the loop's tick calls it once a second. */
void field_purge_continue(service *s);

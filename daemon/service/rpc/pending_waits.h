/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/pending_waits.h: clients that wait for jobs to end (wait, submit with wait). Each is
 * deferred work of the server: it looks at its jobs' states; where some are not final, it sleeps
 * until the last of them ends, or its time is over; then its reply is made, a few jobs at a time.
 * The store is asked no more often than that: many clients may wait for many jobs. */
#ifndef SHEARD_SERVICE_PENDING_WAITS_H
#define SHEARD_SERVICE_PENDING_WAITS_H

#include "server/server.h"

#include <sys/queue.h>

typedef struct service service;

typedef struct pending_waits {
    TAILQ_HEAD(, pending_wait) asleep;
    TAILQ_HEAD(, wait_user) users;
    size_t ids; /* that all users' waits name */
} pending_waits;

/* The server drops them all when it closes. */
void pending_waits_init(pending_waits *all);

/* A submit's reply is to come when its job has ended. */
void pending_waits_add_submitted(service *s, server_handle to, bool known, int64_t id);
void pending_waits_job_ended(service *s, int64_t id);
void pending_waits_tick(service *s); /* once a second: some have waited long enough */

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/subscriptions.h: the jobs and fields that a connection watches. */
#pragma once

#include "sheard/rpc.h"

/* One of them. */
typedef struct subscription {
    int64_t job;
    char *field; /* NULL: a job */
} subscription;

typedef struct subscriptions {
    subscription *items; /* [n] of [capacity], jobs by number, then fields by name */
    size_t n, n_jobs, capacity;
    bool all, progress;
} subscriptions;

void subscriptions_deinit(subscriptions *w); /* a zeroed struct is accepted */
/* Add subscriptions, or none of them on an error. `limit` bounds jobs and fields together. */
int subscriptions_add(subscriptions *w, const sheard_msg_subscribe *what, size_t limit,
                      sheard_rpc_error *error);
/* Remove subscriptions; all of them if `what` names nothing. */
void subscriptions_remove(subscriptions *w, const sheard_msg_subscribe *what);
/* End the subscription to a job by its number. Return false if there was none. */
bool subscriptions_end_job(subscriptions *w, int64_t job);
/* Return whether there is any subscription. */
bool subscriptions_any(const subscriptions *w);
/* Return whether the notification about `job` (0: none) or `field` (NULL: none) is subscribed to.
 */
bool subscriptions_match(const subscriptions *w, enum sheard_notice notice, int64_t job,
                         const char *field);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/pending_waits.h: clients that wait for jobs to end (wait, submit with wait). Each
 * wait is deferred work of the server: it reads its jobs' states, sleeps until the last unfinished
 * one ends or its time is over, and then makes its reply, a few jobs at a time. The store is read
 * no more often than that, since many clients may wait for many jobs. */
#pragma once

#include "server/server.h"
#include "store/store.h"

#include <sys/queue.h>

typedef struct service service;

typedef struct pending_waits {
    TAILQ_HEAD(, pending_wait) first; /* in the order of their requests */
    size_t ids;                       /* number of jobs in them, without submits */
} pending_waits;

/* There is no deinit: the server drops all waits when it closes. */
void pending_waits_init(pending_waits *all);

/* Reply to a submit when its job has ended. */
void pending_waits_add_submitted(service *s, server_handle to, bool known, int64_t id);
void pending_waits_job_ended(service *s, const store_job *job);
void pending_waits_tick(service *s); /* once a second: end the waits whose time is over */

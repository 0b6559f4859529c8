/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/lifecycle.h: running, draining, stopping, and the end of the loop.
 *
 *     RUNNING   accepts jobs
 *     DRAINING  accepts no jobs, finishes those that it has, and continues to serve
 *     STOPPING  accepts and starts no jobs; closes when the running ones have ended or were put
 *               back into the queue, and their results are on disk */
#pragma once

#include "sheard/messages.h"

#include <stdint.h>
#include <uv.h>

typedef struct service service;

typedef struct lifecycle {
    enum sheard_server_state state;
    bool closing;
    bool drain_pending; /* draining, and the end of the last job has not been announced yet */
    uv_timer_t drain_end;
} lifecycle;

void lifecycle_start(service *s);
sheard_msg_stopping lifecycle_get(service *s); /* Return the state, and how many jobs are left. */
void lifecycle_announce(service *s);           /* Publish the same to subscribers. */
void lifecycle_drain(service *s);
/* Enter STOPPING. Running jobs have `timeout_s` seconds to finish; NAN: as configured. */
void lifecycle_stop(service *s, double timeout_s);
void lifecycle_stop_now(service *s);
/* Announce the end of the drain when its last job has ended; close the service if it is stopping
 * and no job runs. Call at the end of each turn. */
void lifecycle_check(service *s);
/* Close the server, which has `flush_ms` milliseconds to send what is left, and then all other
 * handles, so that the loop ends. */
void lifecycle_close(service *s, int64_t flush_ms);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/lifecycle.h: running, draining, stopping, and the end of the loop.
 *
 *     RUNNING   takes jobs
 *     DRAINING  takes none, finishes all that there are, and stays
 *     STOPPING  takes none and starts none; when the running ones have ended or were given back,
 *               and what they left is on disk, the service closes
 */
#ifndef SHEARD_SERVICE_LIFECYCLE_H
#define SHEARD_SERVICE_LIFECYCLE_H

#include "sheard/messages.h"

#include <stdint.h>
#include <uv.h>

typedef struct service service;

typedef struct lifecycle {
    enum sheard_server_state state;
    bool closing;
    bool drain_pending; /* drained jobs are left, and their end is to be told */
    uv_timer_t drain_end;
} lifecycle;

void lifecycle_start(service *s);
sheard_msg_stopping lifecycle_get(service *s); /* the state, and the jobs that are left */
void lifecycle_announce(service *s);           /* the same, to those who watch */
void lifecycle_drain(service *s);
/* STOPPING: running jobs have so long to finish; NAN: as configured. */
void lifecycle_stop(service *s, double timeout_s);
void lifecycle_stop_now(service *s);
/* When a turn has ended: was the last job of the drain, or of the stop, the last one? */
void lifecycle_check(service *s);
/* Close the server, in at most so much time, then all that is left: the loop ends. */
void lifecycle_close(service *s, int64_t flush_ms);

#endif

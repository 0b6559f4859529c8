/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/probe.h: the method probe: can this service measure? A tiny field of known shear goes
 * the way of every job through the engine (reader, sandbox, plan, workers), and past the store. One
 * at a time: who asks meanwhile gets the same answer. */
#ifndef SHEARD_SERVICE_PROBE_H
#define SHEARD_SERVICE_PROBE_H

#include "engine/engine.h"
#include "server/server.h"

typedef struct service service;

enum { PROBE_ASKING = 16 };

typedef struct probe {
    server_handle asking[PROBE_ASKING];
    size_t n_asking; /* > 0: a probe is under way */
    uv_work_t work;
    int fd, code; /* of the field's file */
    shear_error err;
    double begun_s;
    unsigned guards; /* enum sandbox_guard */
} probe;

/* The engine has an event about none of the store's jobs. */
void probe_event(service *s, const engine_event *e);

#endif

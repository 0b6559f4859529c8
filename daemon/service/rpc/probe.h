/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/probe.h: the method probe: can this service measure? A tiny field of known shear
 * passes through the engine (reader, sandbox, plan, workers) like any job, but not through the
 * store. Probes run one at a time; requests that come meanwhile get the same reply. */
#pragma once

#include "engine/engine.h"
#include "server/server.h"

typedef struct service service;

enum { PROBE_ASKING = 16 };

typedef struct probe {
    server_handle asking[PROBE_ASKING];
    size_t n_asking; /* above 0: a probe is under way */
    uv_work_t work;
    int fd, code; /* of the field's file */
    shear_error err;
    double begun_s;
    unsigned guards; /* bits of enum sandbox_guard */
} probe;

/* Process an event of the engine about a job that is not in the store. */
void probe_event(service *s, const engine_event *e);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/probe.h: the method probe: can this service measure? A tiny field of known shear goes
 * the way of every job through the engine (reader, sandbox, plan, workers), and past the store. One
 * at a time: who asks meanwhile gets the same answer. */
#ifndef SHEARD_SERVICE_PROBE_H
#define SHEARD_SERVICE_PROBE_H

#include "engine/engine.h"

typedef struct service service;
typedef struct probe probe;

/* The engine has an event about none of the store's jobs. */
void probe_event(service *s, const engine_event *e);
void probe_free(probe *p);

#endif

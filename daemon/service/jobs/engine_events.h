/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/engine_events.h: from the engine's events into the store. */
#ifndef SHEARD_SERVICE_ENGINE_EVENTS_H
#define SHEARD_SERVICE_ENGINE_EVENTS_H

typedef struct service service;

/* All that the engine has to tell. */
void engine_events_process(service *s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/engine_events.h: store what the engine reports: opened files, checkpoints, results,
 * failures. */
#pragma once

typedef struct service service;

/* Process all events of the engine's queue. */
void engine_events_process(service *s);

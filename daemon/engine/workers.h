/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/workers.h: the worker threads, which measure the stamps of all jobs. */
#ifndef SHEARD_ENGINE_WORKERS_H
#define SHEARD_ENGINE_WORKERS_H

#include "engine/internal.h"

typedef struct worker_start {
    engine *e;
    int slot;
} worker_start;

/* Run a worker until the engine stops. The argument is a worker_start, which is freed. */
void *worker_main(void *start);

#endif

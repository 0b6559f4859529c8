/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/workers.h: the threads that measure. */
#ifndef SHEARD_ENGINE_WORKERS_H
#define SHEARD_ENGINE_WORKERS_H

#include "engine/internal.h"

typedef struct worker_start {
    engine *e;
    int slot;
} worker_start;

/* A worker's thread; the argument is a worker_start, which is freed. It ends with the engine. */
void *worker_main(void *start);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/workers.h: the worker threads, which measure the stamps of all jobs. */
#pragma once

#include "engine/internal.h"

typedef struct worker_start {
    engine *e;
    int slot;
} worker_start;

/* Run a worker until the engine stops. The argument is a worker_start, which is freed. */
void *worker_main(void *start);

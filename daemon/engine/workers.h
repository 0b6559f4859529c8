/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/workers.h: the worker threads, which measure the stamps of all jobs. */
#pragma once

/* Run a worker until the engine stops. The argument is a worker of the engine's. */
void *worker_main(void *worker);

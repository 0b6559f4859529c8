/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cache.h: the result cache of an experiment, so that a long run can be stopped and continued.
 *
 * The work is divided into tasks (for example, one point of a figure), and each task into chunks.
 * The result of a chunk, a row of doubles, is appended to a state file and synced before the next
 * chunk begins. The file is OUT/NAME-KEY.state, where KEY is a hash of everything that the numbers
 * depend on (options_describe): a run with the same settings and seed skips finished chunks, and
 * other settings use another file. A line that a crash has cut off is dropped. Numbers are written
 * in hexadecimal, without rounding. */
#pragma once

#include "engine/options.h"

#include <stdint.h>

typedef struct cache cache;

/* Open or create the state. `total` is the number of stamps that all tasks draw, for the progress
 * line. Ends the program if another process uses the same state. */
cache *cache_open(const options *o, int64_t total);
void cache_close(cache *c);

typedef struct cache_task {
    const char *name; /* unique in the experiment, without spaces */
    int chunks;
    int values;              /* number of results of a chunk */
    int64_t stamps_of_chunk; /* for the progress line */
    /* Compute values[] of one chunk; it may use all threads, and must not depend on their number.
     */
    void (*work)(void *context, int chunk, double *values);
    void *context;
} cache_task;

/* Return the results [chunks][task->values], to be freed by the caller; those in the state are
 * read, others are computed and stored. */
double *cache_run(cache *c, const cache_task *task);

/* Return the wall clock time of all chunks in seconds, in this run and earlier ones. */
double cache_seconds(const cache *c);

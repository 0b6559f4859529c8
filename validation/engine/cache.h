/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cache.h: the result cache of an experiment: long runs may be stopped at any time and continue.
 *
 * Work is cut into tasks (a point of the figure, say) and a task into chunks. What a chunk yields,
 * a row of doubles, is appended to a state file and synced before the next chunk begins. The file
 * is OUT/NAME-KEY.state, KEY a hash of everything that the numbers depend on (options_describe), so
 * that a second start with the same settings and seed skips what is finished, and other settings do
 * not disturb it. A line that was cut off by a crash is dropped. Numbers are written in
 * hexadecimal, to the last bit.
 */
#ifndef VALIDATION_CACHE_H
#define VALIDATION_CACHE_H

#include "engine/options.h"

#include <stdint.h>

typedef struct cache cache;

/* Open or create the state; `total` is how many stamps all tasks will draw, for the progress line.
 * Ends the program where another process works on the same state. */
cache *cache_open(const options *o, int64_t total);
void cache_close(cache *c);

typedef struct cache_task {
    const char *name; /* unique in the experiment, no blanks */
    int chunks;
    int values;              /* a chunk yields so many */
    int64_t stamps_of_chunk; /* for the progress line */
    /* Compute values[] of one chunk; it may use all threads, and must not depend on their number.
     */
    void (*work)(void *context, int chunk, double *values);
    void *context;
} cache_task;

/* [chunks][task->values], for free(): from the state where it has them, else computed and kept. */
double *cache_run(cache *c, const cache_task *task);

/* Seconds of wall clock that all chunks took, in this run and in earlier ones. */
double cache_seconds(const cache *c);

#endif

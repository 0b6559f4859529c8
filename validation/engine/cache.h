/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ledger.h: the durable memory of an experiment: long runs may be stopped at any time and go on.
 *
 * Work is cut into tasks (a point of the figure, say) and a task into chunks. What a chunk yields,
 * a row of doubles, is appended to a state file and synced before the next chunk begins. The file
 * is OUT/NAME-KEY.state, KEY a hash of everything that the numbers depend on (request_describe), so
 * that a second start with the same settings and seed skips what is finished, and other settings do
 * not disturb it. A line that was cut off by a crash is dropped. Numbers are written in
 * hexadecimal, to the last bit.
 */
#ifndef VALIDATION_LEDGER_H
#define VALIDATION_LEDGER_H

#include "engine/options.h"

#include <stdint.h>

struct ledger;

/* Open or create the state; `total` is how many stamps all tasks will draw, for the progress line.
 * SHEAR_E_IO, SHEAR_E_NOMEM; SHEAR_E_EXISTS where another process works on the same state. */
int ledger_open(struct ledger **ledger, const struct request *r, int64_t total, shear_error *err);
void ledger_close(struct ledger *ledger);

struct task {
    const char *name; /* unique in the experiment, no blanks */
    int chunks;
    int values;              /* a chunk yields so many */
    int64_t stamps_of_chunk; /* for the progress line */
    /* Compute values[] of one chunk; it may use all threads, and must not depend on their number.
     */
    int (*work)(void *context, int chunk, double *values, shear_error *err);
    void *context;
};

/* values [chunks][task->values]: from the state where it has them, else computed and kept. */
int ledger_run(struct ledger *ledger, const struct task *task, double *values, shear_error *err);

/* Seconds of wall clock that all chunks took, in this run and in earlier ones. */
double ledger_seconds(const struct ledger *ledger);

#endif

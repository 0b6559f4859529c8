/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/work.h: one field file as work for a team of threads, whoever owns the threads and wherever
 * the stamps come from.
 *
 * A thread takes a work unit (a run of whole blocks), reads its stamps from the source, measures
 * them, and hands rows and sums over. Results are summed in index order: those that come early are
 * kept. So at any time the sums cover exactly the blocks [first_block, next_block): a
 * checkpoint from which the work can be resumed. shear_run_file (shear/run.h) is this with OpenMP
 * threads and a file; the service brings its own workers.
 */
#ifndef SHEAR_WORK_H
#define SHEAR_WORK_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/sums.h"
#include "shear/symmetry.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where stamps come from. `read` is called by one thread at a time (the work's lock is held), and
 * gives pairs [first, first+count) as *block, which stays valid until the same slot reads again.
 * Slots are 0 .. slots-1, one per worker. */
typedef struct shear_source {
    void *self;
    int (*read)(void *self, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err);
    bool concurrent; /* `read` may run in several threads at once, each with a slot of its own */
} shear_source;

/* Where rows go, or {0}. `write` is called by one thread at a time, in any order of stamps. */
typedef struct shear_sink {
    void *self;
    int (*write)(void *self, int64_t first, int count, const shear_row *rows,
                 const shear_block *block, shear_error *err);
    /* May be NULL. Bring rows [0, rows) to where they outlive the process. Not while `write` runs.
     */
    int (*sync)(void *self, int64_t rows, shear_error *err);
} shear_sink;

/* How much a thread takes at a time. */
typedef struct shear_unit_size {
    int blocks; /* whole blocks in a unit */
    int stamps; /* stamps in one read; less than a block for large stamps */
} shear_unit_size;
/* About 1 MiB of pixels, and never so much that a thread of `threads` would be idle. */
shear_unit_size shear_unit_size_for(const shear_field_info *info, int threads);

typedef struct shear_work_spec {
    const shear_field_info *info; /* kept by the caller while the work lives, as all below */
    const shear_plan *plan;
    shear_source source;
    shear_unit_size size;
    int64_t first_block; /* 0, or where a checkpoint left off */
    shear_sink sink;
    shear_jackknife *jackknife; /* or NULL; fed in block order */
    bool terms; /* keep the stamps' terms, also where the plan's estimator needs none */
} shear_work_spec;

typedef struct shear_work shear_work;
int shear_work_new(shear_work **work, const shear_work_spec *spec, shear_error *err);
void shear_work_free(shear_work *work); /* no thread may be in it */

/* One thread's scratch. A worker may serve one work after another that have the same plan and
 * unit size. */
typedef struct shear_worker shear_worker;
int shear_worker_new(shear_worker **worker, const shear_plan *plan, shear_unit_size size, int slot,
                     shear_error *err);
void shear_worker_free(shear_worker *worker);
int64_t shear_worker_bytes(const shear_plan *plan, shear_unit_size size); /* what one takes */

/* Take and finish one unit. Thread-safe. Returns false where nothing is left to take, or the work
 * has failed or was stopped; units of other threads may still be under way. */
bool shear_work_step(shear_work *work, shear_worker *worker);

/* Let no further unit begin; units under way are finished. Thread-safe. */
void shear_work_stop(shear_work *work);

/* Let it fail as if a unit had: for what goes wrong around it. Thread-safe. */
void shear_work_fail(shear_work *work, const shear_error *err);

/* Where it stands; thread-safe. `code` is not SHEAR_OK after
 * a failure. */
typedef struct shear_work_status {
    int64_t stamps_done; /* since the start of the file, by all threads, in whatever order */
    int64_t stamps_total;
    int64_t next_block; /* blocks before it are in the sums */
    bool complete;      /* all blocks are */
    bool exhausted;     /* nothing is left to take (all taken, stopped or failed) */
    int units_under_way;
    int code; /* of the failed unit that comes first in the file */
} shear_work_status;
shear_work_status shear_work_get_status(shear_work *work);
/* The first failure in the file; only where code is not SHEAR_OK. */
int shear_work_get_error(shear_work *work, shear_error *err);

/* Have the sink keep the rows of blocks [0, next_block), which are in the sums; nothing where it
 * cannot. Thread-safe; other threads wait with their rows meanwhile. */
int shear_work_sync(shear_work *work, int64_t next_block, shear_error *err);

/* Add the sums so far to `sums` (exact) and return next_block; thread-safe. */
int64_t shear_work_join_into(shear_work *work, shear_field_sums *sums);

/* The same with the terms of the same stamps from the `from`-th on, which are kept where the plan's
 * estimator is pdf-sym or the spec says so: added to `terms`. On error nothing has been added to
 * either. */
int shear_work_join_terms(shear_work *work, shear_field_sums *sums, size_t from,
                          shear_symmetry *terms, int64_t *next_block, shear_error *err);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/work.h
 * One field as work for a team of threads, whoever owns the threads and wherever the stamps come
 * from.
 *
 * A thread takes a work unit (a run of whole blocks), reads its stamps from the source, measures
 * them, and hands rows and sums over. Results are summed in index order: those that come
 * early wait. So at any time the sums cover exactly the blocks [first_block, next_block): a
 * checkpoint from which the work can be resumed. shear_run_file() is this with OpenMP threads and a
 * file; the service brings its own workers.
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

/** Where stamps come from. */
typedef struct shear_source {
    void *self; /**< the first argument of `read` */
    /** Gives pairs [first, first+count) as *block, which stays valid until the same slot reads
     * again. Slots are 0 .. slots-1, one per worker. Called by one thread at a time (the work's
     * lock is held) unless `concurrent`. */
    int (*read)(void *self, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err);
    bool concurrent; /**< `read` may run in several threads at once, each with a slot of its own */
} shear_source;

/** Where rows go, or {0}. */
typedef struct shear_sink {
    void *self; /**< the first argument of `write` and `sync` */
    /** Takes rows [first, first+count). Called by one thread at a time, in any order of stamps. */
    int (*write)(void *self, int64_t first, int count, const shear_row *rows,
                 const shear_block *block, shear_error *err);
    /** Brings rows [0, rows) to a place that outlives the process. Never while `write` runs. May be
     * NULL. */
    int (*sync)(void *self, int64_t rows, shear_error *err);
} shear_sink;

/** How much a thread takes at a time. */
typedef struct shear_unit_size {
    int blocks; /**< whole blocks in a work unit */
    int stamps; /**< stamps in one read; less than a block for large stamps */
} shear_unit_size;
/** About 1 MiB of pixels, and never so much that one of `threads` threads would be idle. */
shear_unit_size shear_unit_size_for(const shear_field_info *info, int threads);

/** What a work is made from. The caller keeps all that it points to while the work lives. */
typedef struct shear_work_spec {
    const shear_field_info *info; /**< the field */
    const shear_plan *plan;       /**< its plan */
    shear_source source;          /**< of its stamps */
    shear_unit_size size;         /**< of a work unit */
    int64_t first_block;          /**< 0, or the next_block of a checkpoint */
    shear_sink sink;              /**< of its rows */
    shear_jackknife *jackknife;   /**< gets its blocks in order; or NULL */
    bool terms; /**< keep the stamps' terms even if the plan's estimator needs none */
} shear_work_spec;

/** The work. */
typedef struct shear_work shear_work;
/** *work is NULL on error. */
int shear_work_new(shear_work **work, const shear_work_spec *spec, shear_error *err);
/** No thread may be in it. NULL is accepted. */
void shear_work_free(shear_work *work);

/** One thread's scratch memory. A worker may serve one work after another if they have the same
 * plan and unit size. */
typedef struct shear_worker shear_worker;
/** *worker is NULL on error. */
int shear_worker_new(shear_worker **worker, const shear_plan *plan, shear_unit_size size, int slot,
                     shear_error *err);
/** NULL is accepted. */
void shear_worker_free(shear_worker *worker);
/** The bytes that a worker takes. */
int64_t shear_worker_bytes(const shear_plan *plan, shear_unit_size size);

/** Take and finish one work unit. Thread-safe, with a worker per thread. Returns false if nothing
 * is left to take, or the work has failed or was stopped; other threads may still have units in
 * hand. */
bool shear_work_step(shear_work *work, shear_worker *worker);

/** Let no further unit begin; those that have begun are finished. Thread-safe. */
void shear_work_stop(shear_work *work);

/** Let it fail as if a unit had failed: for what goes wrong around it. Thread-safe. */
void shear_work_fail(shear_work *work, const shear_error *err);

/** How a work stands. */
typedef struct shear_work_status {
    int64_t stamps_done;  /**< since the start of the file, by all threads, in any order */
    int64_t stamps_total; /**< of the field */
    int64_t next_block;   /**< the sums, which a checkpoint has, cover all blocks before it */
    bool complete;        /**< the sums cover all blocks */
    bool exhausted;       /**< nothing is left to take (all taken, stopped or failed) */
    int units_under_way;  /**< units that threads have in hand */
    int code; /**< of the failed unit that comes first in the file; SHEAR_OK: none failed */
} shear_work_status;
/** How it stands. Thread-safe. */
shear_work_status shear_work_get_status(shear_work *work);
/** The first failure in the file, if the status has its code. Thread-safe. */
int shear_work_get_error(shear_work *work, shear_error *err);

/** Have the sink sync the rows of blocks [0, next_block), which are in the sums; nothing if it
 * cannot. Thread-safe; other threads wait with their rows meanwhile. */
int shear_work_sync(shear_work *work, int64_t next_block, shear_error *err);

/** Add the sums so far to `sums` (exact) and return next_block. Thread-safe. */
int64_t shear_work_join_into(shear_work *work, shear_field_sums *sums);

/** The same with the terms of the same stamps, from number `from` on, which are kept if the plan's
 * estimator is symmetric or the spec says so: they are added to `terms`. On error nothing has been
 * added to either. Thread-safe. */
int shear_work_join_terms(shear_work *work, shear_field_sums *sums, size_t from,
                          shear_symmetry *terms, int64_t *next_block, shear_error *err);

#ifdef __cplusplus
}
#endif

#endif

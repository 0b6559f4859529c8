/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/work.h
 * Measure one field with a team of threads, whoever owns the threads and wherever the stamps come
 * from.
 *
 * A thread claims a work unit (a run of whole blocks), reads its stamps from the source, measures
 * them, and hands over rows and sums. Results are summed in index order; early ones are kept. So at
 * any time the sums cover exactly the blocks [first_block, next_block): a checkpoint from which the
 * work can be resumed. shear_run_file() does this with OpenMP threads and a file; the service
 * provides its own workers.
 */
#ifndef SHEAR_WORK_H
#define SHEAR_WORK_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/linkage.h"
#include "shear/plan.h"
#include "shear/sums.h"
#include "shear/symmetry.h"

SHEAR_BEGIN_C

/** A source of stamps. */
typedef struct shear_source {
    void *self; /**< the first argument of `read` */
    /** Read pairs [first, first+count) into *block, which stays valid until the same slot reads
     * again. Slots are 0 .. slots-1, one per worker. Called by one thread at a time (the work's
     * lock is held) unless `concurrent`. */
    int (*read)(void *self, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err);
    bool concurrent; /**< `read` may be called by several threads at once, each with a slot of its
                        own */
} shear_source;

/** A sink of rows, or {0}. */
typedef struct shear_sink {
    void *self; /**< the first argument of `write` and `sync` */
    /** Store rows [first, first+count). Called by one thread at a time, in any order of stamps. */
    int (*write)(void *self, int64_t first, int count, const shear_row *rows,
                 const shear_block *block, shear_error *err);
    /** Bring rows [0, rows) to storage that outlives the process. Never called while `write` runs.
     * May be NULL. */
    int (*sync)(void *self, int64_t rows, shear_error *err);
} shear_sink;

/** The size of a work unit. */
typedef struct shear_unit_size {
    int blocks; /**< whole blocks in a work unit */
    int stamps; /**< stamps per read; fewer than a block for large stamps */
} shear_unit_size;
/** Return a unit size of about 1 MiB of pixels, but never so large that one of `threads` threads
 * would be idle. */
shear_unit_size shear_unit_size_for(const shear_field_info *info, int threads);

/** The specification of a work. The caller keeps all that it points to while the work exists. */
typedef struct shear_work_spec {
    const shear_field_info *info; /**< the field */
    const shear_plan *plan;       /**< its plan */
    shear_source source;          /**< of its stamps */
    shear_unit_size size;         /**< of a work unit */
    int64_t first_block;          /**< 0, or the next_block of a checkpoint */
    shear_sink sink;              /**< of its rows */
    shear_jackknife *jackknife;   /**< gets the blocks in order; or NULL */
    bool terms; /**< keep the stamps' terms even if the plan's estimator needs none */
} shear_work_spec;

/** One field's work, shared by threads. */
typedef struct shear_work shear_work;
/** Make a work; *work is NULL on error. */
int shear_work_new(shear_work **work, const shear_work_spec *spec, shear_error *err);
/** Free the work, which no thread may be using. NULL is accepted. */
void shear_work_free(shear_work *work);

/** One thread's scratch memory. A worker may serve one work after another if they have the same
 * plan and unit size. */
typedef struct shear_worker shear_worker;
/** Make a worker; *worker is NULL on error. */
int shear_worker_new(shear_worker **worker, const shear_plan *plan, shear_unit_size size, int slot,
                     shear_error *err);
/** Free the worker. NULL is accepted. */
void shear_worker_free(shear_worker *worker);
/** Return the bytes of a worker. */
int64_t shear_worker_bytes(const shear_plan *plan, shear_unit_size size);

/** Claim and finish one work unit. Thread-safe, with a worker per thread. Return false if no unit
 * is left, or the work has failed or was stopped; other threads may still be working on units. */
bool shear_work_step(shear_work *work, shear_worker *worker);

/** Start no further unit; those that have begun are finished. Thread-safe. */
void shear_work_stop(shear_work *work);

/** Fail the work as if a unit had failed, for errors outside it. Thread-safe. */
void shear_work_fail(shear_work *work, const shear_error *err);

/** The status of a work. */
typedef struct shear_work_status {
    int64_t stamps_done;  /**< since the start of the file, by all threads, in any order */
    int64_t stamps_total; /**< of the field */
    int64_t next_block;   /**< the sums, and a checkpoint of them, cover all blocks before it */
    bool complete;        /**< the sums cover all blocks */
    bool exhausted;       /**< no unit is left (all claimed, stopped or failed) */
    int units_under_way;  /**< units that threads are working on */
    int code; /**< of the failed unit that comes first in the file; SHEAR_OK: none failed */
} shear_work_status;
/** Return the status. Thread-safe. */
shear_work_status shear_work_get_status(shear_work *work);
/** Return the code of the first failure in the file, and copy it to *err; SHEAR_OK if there is
 * none. Thread-safe. */
int shear_work_get_error(shear_work *work, shear_error *err);

/** Have the sink sync the rows of blocks [0, next_block), which are in the sums; do nothing if the
 * sink has no `sync`. Thread-safe; other threads wait with their rows meanwhile. */
int shear_work_sync(shear_work *work, int64_t next_block, shear_error *err);

/** Add the sums so far to `sums` (exact) and return next_block. Thread-safe. */
int64_t shear_work_join_into(shear_work *work, shear_field_sums *sums);

/** The same, and add the terms of the same stamps, from stamp number `from` on, to `terms`. They
 * are kept if the plan's estimator is symmetric or the spec says so. On error nothing has been
 * added to either. Thread-safe. */
int shear_work_join_terms(shear_work *work, shear_field_sums *sums, size_t from,
                          shear_symmetry *terms, int64_t *next_block, shear_error *err);

SHEAR_END_C

#endif

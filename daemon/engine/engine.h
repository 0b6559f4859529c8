/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/engine.h: the worker threads and the jobs they measure. The engine uses no event loop, SQL
 * or JSON.
 *
 * The stages of a job:
 *
 *     the owner calls     what happens                                     events
 *     engine_add          a thread of the job starts a reader,             OPENED, or FAILED
 *                         has it hash the file, and has a plan made
 *     engine_go           the workers measure its blocks, unit by unit     RESUMED, CHECKPOINT
 *     or engine_stop_job  its own thread finishes it                       DONE, FAILED, STOPPED
 *
 * The last event of a job is DONE, FAILED or STOPPED; the job is freed before it is reported.
 * Workers choose the job of the highest priority, and of equals the one that has been served the
 * fewest stamps, so that a small job does not wait behind a large one. A worker that would have to
 * wait for a job's reader serves another job meanwhile, so a file that hangs delays its own job
 * only.
 *
 * All functions are called by one thread, the owner's (the loop); none waits for a file, except
 * engine_free. Events are queued; `wake` is called from any thread when there are new ones. */
#pragma once

#include "engine/plan_cache.h"
#include "reader/reader.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/sums.h"
#include "shear/symmetry.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct engine engine;

enum engine_code {
    ENGINE_E_CHANGED = 120, /* a file changed between engine_add and its last block */
    ENGINE_E_MEMORY = 121   /* the job needs more memory than the whole budget */
};

typedef struct engine_options {
    int workers;           /* >= 1 */
    reader_limits limits;  /* the strings are copied */
    int64_t checkpoint_ms; /* shortest time between two checkpoints of a job */
    int64_t plans_count;   /* most plans kept for later jobs: engine/plan_cache.h */
    int64_t plans_bytes;
    int64_t memory_bytes; /* budget of jobs and plans together: engine/budget.h */
    void (*wake)(void *context);
    void *context;
} engine_options;

typedef struct engine_job {
    int64_t id;               /* chosen by the owner, unique */
    int priority;             /* higher values first */
    const shear_input *input; /* file names, for messages and the default field; copied */
    const int *fds; /* open files, as for shear_field_open_input; the engine closes them, also if
                       engine_add fails */
    shear_settings settings;
    const char *catalog; /* path of the result catalog, or NULL; copied. An existing file is
                            replaced. The temporary file (shear_catalog_begin) is kept unless the
                            job is DONE; the owner removes it when the job is over */
} engine_job;

/* Where a resumed job continues: the sums of blocks [0, next_block). */
typedef struct engine_checkpoint {
    int64_t next_block;
    const char *sums;            /* text of shear_field_sums_format; copied */
    const shear_symmetry *terms; /* of the same stamps, or NULL; copied */
} engine_checkpoint;

enum engine_event_kind {
    ENGINE_OPENED,
    ENGINE_RESUMED,
    ENGINE_CHECKPOINT,
    ENGINE_DONE,
    ENGINE_FAILED,
    ENGINE_STOPPED
};

typedef struct engine_event {
    enum engine_event_kind kind;
    int64_t job;
    char checksum[SHEAR_CHECKSUM_SIZE]; /* OPENED: hash of the content (shear_input_checksum) */
    shear_field_info info;              /* OPENED */
    shear_plan_info plan;               /* OPENED */
    unsigned guards;                    /* OPENED: reader_get_guards */
    int64_t next_block;                 /* CHECKPOINT, RESUMED */
    char *sums;                         /* CHECKPOINT, DONE: text, freed by engine_event_deinit */
    int64_t from_block;                 /* CHECKPOINT: first block of its terms */
    unsigned char *terms; /* terms (shear_symmetry_bytes) if the estimator is symmetric, else NULL:
                             of blocks [from_block, next_block) in a CHECKPOINT, of all stamps in a
                             DONE; freed likewise */
    size_t terms_size;    /* bytes */
    shear_result result;  /* DONE: result of this file alone */
    double seconds;       /* DONE: time from engine_add to the end */
    shear_error error;    /* FAILED: code of shear/error.h, reader/reader.h or enum engine_code */
} engine_event;
/* Free the memory that an event owns. */
void engine_event_deinit(engine_event *event);

/* Start the worker threads. `limits.program` and `limits.scratch` are copied. On an error *e is
 * NULL. */
int engine_new(engine **e, const engine_options *options, shear_error *err);
/* Stop all jobs after their current work units, join the threads, and drop unread events. NULL is
 * accepted. */
void engine_free(engine *e);

/* Add a job and start its thread. On an error (SHEAR_E_NOMEM) there is no event. */
int engine_add(engine *e, const engine_job *job, shear_error *err);
/* Measure an OPENED job, from the checkpoint if it is not NULL. RESUMED has the first block: 0 if
 * the catalog lacks rows before the checkpoint, or if the terms do not belong to the sums. */
void engine_go(engine *e, int64_t job, const engine_checkpoint *checkpoint);
/* Stop a job. Its last event is STOPPED (after a CHECKPOINT if there is anything to save), unless
 * it was already DONE or FAILED. Current work units are finished, unless a reader does not answer
 * within a second. */
void engine_stop_job(engine *e, int64_t job);

/* Take the next event. Return false if there is none. */
bool engine_next_event(engine *e, engine_event *event);

/* What a job is doing. */
enum engine_stage {
    ENGINE_OPENING, /* its reader starts, and opens (and unpacks) the files */
    ENGINE_HASHING, /* the reader hashes the files */
    ENGINE_WAITING_MEMORY,
    ENGINE_PREPARING, /* its plan is made; then it waits for engine_go */
    ENGINE_MEASURING,
    ENGINE_FINISHING
};

typedef struct engine_progress {
    enum engine_stage stage;
    int64_t hashed, bytes; /* bytes of the files: hashed so far, and in all */
    int64_t done, total;   /* stamps; total is -1 before and after MEASURING */
} engine_progress;
/* Return how far a job is in *progress. Return false if the engine does not have the job. */
bool engine_get_progress(engine *e, int64_t job, engine_progress *progress);
/* Add the job's sums so far to `sums`, for a field's running average. Return false if the engine
 * does not have the job, or it is not being measured. */
bool engine_partial(engine *e, int64_t job, shear_field_sums *sums);

/* Return the directory for unpacked copies, as it was given. */
const char *engine_get_scratch(const engine *e);

typedef struct engine_load {
    int workers, busy;    /* threads, and those working now */
    int jobs;             /* jobs in the engine */
    int64_t stamps_total; /* measured since the start */
    int64_t blocks_left;  /* unmeasured blocks of the jobs that are being measured */
    int64_t memory_total; /* the budget, in bytes */
    int64_t memory_used;  /* bytes reserved by jobs or taken by plans */
    int memory_waiting;   /* jobs waiting for memory */
    plan_cache_statistics plans;
} engine_load;
engine_load engine_get_load(engine *e);

/* Change the limits of the readers of later jobs; the paths stay. */
void engine_limit_readers(engine *e, const reader_limits *limits);
/* Change the budget. */
void engine_limit_memory(engine *e, int64_t bytes);
/* Change the limits of the kept plans. */
void engine_limit_plans(engine *e, int64_t count, int64_t bytes);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/engine.h: the worker threads and the jobs they work on. Knows no loop, no SQL, no JSON.
 *
 * A job goes through the engine like this:
 *
 *     the owner calls     what happens                                     events
 *     engine_add          a thread of the job's own starts a reader,       OPENED, or FAILED
 *                         has it hash the file, and has a plan made
 *     engine_go           the workers measure its blocks, unit by unit     RESUMED, CHECKPOINT
 *     or engine_stop_job  its own thread finishes it                       DONE, FAILED, STOPPED
 *
 * The last event of a job is DONE, FAILED or STOPPED; after it the engine has forgotten the job.
 * Workers choose among the jobs by priority, and among equals the one that has had the fewest
 * stamps of late, so that a small job does not wait behind a large one. A worker that would have to
 * wait for a job's reader serves another job meanwhile: a file that hangs holds up its own job.
 *
 * The owner is one thread (the loop's); no call waits for a file. Events are queued; `wake` is
 * called from any thread when there are some.
 */
#ifndef SHEARD_ENGINE_H
#define SHEARD_ENGINE_H

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
    ENGINE_E_CHANGED = 120, /* a file changed between its hash and the last block */
    ENGINE_E_MEMORY = 121   /* the job needs more memory than all may have together */
};

typedef struct engine_options {
    int workers;           /* >= 1 */
    reader_limits limits;  /* texts are copied */
    int64_t checkpoint_ms; /* least time between two checkpoints of a job */
    int64_t plans_count;   /* plans kept at most for later jobs: engine/plan_cache.h */
    int64_t plans_bytes;
    int64_t memory_bytes; /* that jobs and plans may take together: engine/budget.h */
    void (*wake)(void *context);
    void *context;
} engine_options;

typedef struct engine_job {
    int64_t id;               /* the owner's name for it */
    int priority;             /* higher first */
    const shear_input *input; /* its names, for messages and the default field; copied */
    const int *fds;           /* its open files, as of shear_field_open_input: the engine closes
                                 them, also when engine_add fails */
    shear_settings settings;
    const char *catalog; /* path, or NULL; copied. Replaced where it exists. Its temporary file
                              (shear_catalog_begin) stays unless the job is DONE: the owner's to
                              forget when the job is over */
} engine_job;

/* Where a resumed job goes on: the sums of blocks [0, next_block). */
typedef struct engine_checkpoint {
    int64_t next_block;
    const char *sums;            /* shear_field_sums_format; copied */
    const shear_symmetry *terms; /* of the same stamps, where estimator = pdf-sym; copied */
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
    char checksum[SHEAR_CHECKSUM_SIZE]; /* OPENED: of the content (shear_input_checksum) */
    shear_field_info info;              /* OPENED */
    shear_plan_info plan;               /* OPENED */
    unsigned guards;                    /* OPENED: reader_get_guards */
    int64_t next_block;                 /* CHECKPOINT, RESUMED */
    char *sums;                         /* CHECKPOINT, DONE: text; freed by engine_event_deinit */
    int64_t from_block;                 /* CHECKPOINT: where its terms begin */
    unsigned char *terms; /* where estimator = pdf-sym, shear_symmetry_bytes: of blocks
                             [from_block, next_block) of a CHECKPOINT, of all stamps of a
                             DONE job; freed likewise; else NULL */
    size_t terms_size;    /* bytes */
    shear_result result;  /* DONE: of this file alone */
    double seconds;       /* DONE: spent on it in this process */
    shear_error error;    /* FAILED: code as of shear/error.h, reader/reader.h or above */
} engine_event;
void engine_event_deinit(engine_event *event);

int engine_new(engine **e, const engine_options *options, shear_error *err);
/* Stops all jobs after the units of work under way, joins the threads, drops unread events. NULL is
 * accepted. */
void engine_free(engine *e);

int engine_add(engine *e, const engine_job *job, shear_error *err);
/* After OPENED: measure it, from the checkpoint if there is one. RESUMED tells the block that it
 * begins with: 0 where the rows before the checkpoint are missing in the catalog, or terms do not
 * belong to the sums. */
void engine_go(engine *e, int64_t job, const engine_checkpoint *checkpoint);
/* Stop a job: its last event is STOPPED (after a CHECKPOINT where there is something to save),
 * unless it was DONE or FAILED already. Units of work under way are finished,
 * unless a reader does not answer for a second. */
void engine_stop_job(engine *e, int64_t job);

/* The next event; false where there is none. */
bool engine_next_event(engine *e, engine_event *event);

/* What a job is at. */
enum engine_stage {
    ENGINE_OPENING, /* its reader starts, and opens (and unpacks) the files */
    ENGINE_HASHING, /* the reader reads them whole, for their hash */
    ENGINE_WAITING_MEMORY,
    ENGINE_PREPARING, /* its plan is made; then it waits for the owner's word */
    ENGINE_MEASURING,
    ENGINE_FINISHING
};

typedef struct engine_progress {
    enum engine_stage stage;
    int64_t hashed, bytes; /* of the files: so far, and in all */
    int64_t done, total;   /* stamps; total -1 where it is not MEASURING */
} engine_progress;
/* How far a job is; false where the engine does not know it. */
bool engine_get_progress(engine *e, int64_t job, engine_progress *progress);
/* Add the sums of the job so far to `sums`, for a field's running average; false as above, or where
 * it has not begun. */
bool engine_partial(engine *e, int64_t job, shear_field_sums *sums);

/* The directory for unpacked copies, as it was given. */
const char *engine_get_scratch(const engine *e);

typedef struct engine_load {
    int workers, busy;    /* threads, and those at work now */
    int jobs;             /* in the engine */
    int64_t stamps_total; /* measured since the start */
    int64_t blocks_left;  /* of the jobs that are being measured: not yet measured */
    int64_t memory_total; /* the budget */
    int64_t memory_used;  /* of it, by jobs and plans */
    int memory_waiting;   /* jobs that wait for some */
    plan_cache_statistics plans;
} engine_load;
engine_load engine_get_load(engine *e);

/* Other limits for the readers of jobs that are added from now on; the paths stay. */
void engine_limit_readers(engine *e, const reader_limits *limits);
/* Another budget, from now on. */
void engine_limit_memory(engine *e, int64_t bytes);
/* Other bounds for the kept plans, from now on. */
void engine_limit_plans(engine *e, int64_t count, int64_t bytes);

#endif

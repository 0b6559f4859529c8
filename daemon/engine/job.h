/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job.h: one job inside the engine: its reader, plan and work. The engine's lock guards the
 * members from `phase` to `waiting_since`; the rest belongs to the job's own thread, or is
 * thread-safe by itself. */
#ifndef SHEARD_ENGINE_JOB_H
#define SHEARD_ENGINE_JOB_H

#include "engine/engine.h"
#include "engine/job_files.h"
#include "engine/plan_cache.h"
#include "shear/catalog.h"
#include "shear/run.h"
#include "shear/work.h"

#include <pthread.h>

enum job_phase {
    JOB_PREPARING, /* its own thread has it */
    JOB_OPENED,    /* waits for the owner's word, or begins */
    JOB_MEASURING, /* workers have it */
    JOB_FINISHING  /* its own thread has it */
};

typedef struct job {
    struct job *next; /* in the engine's list */
    engine *engine;
    int64_t id;
    int priority;
    enum job_phase phase;
    bool go, stop_asked;
    atomic_bool stopping;  /* stop_asked, for the reader, which does not know the lock */
    atomic_int stage;      /* enum engine_stage, for engine_get_progress */
    atomic_llong hashed;   /* bytes of the files */
    int64_t bytes;         /* of the files, in all */
    int64_t served;        /* stamps of whole units of work, for fairness */
    int64_t counted;       /* stamps measured that are in the engine's total */
    int holders;           /* workers that are at this job */
    int reading;           /* of those, the ones that read, or are about to */
    bool *entering;        /* [workers] about to read for the first time in its unit of work */
    int team_size;         /* workers that may serve it: memory is reserved for so many */
    int members;           /* those that do, up to now */
    bool *is_member;       /* [workers] */
    int64_t reserved;      /* bytes of the budget */
    int64_t waiting_since; /* it waits for memory: its ticket; else 0 */

    job_files files;
    char *catalog_path;
    shear_settings settings;
    reader_limits limits;
    int workers;

    reader *reader;
    const shear_plan *plan; /* the engine's; given back at the end */
    shear_catalog *catalog;
    int64_t first_block;          /* the checkpoint's, 0: none */
    char *sums_before;            /* and its sums as text */
    shear_field_sums *before;     /* these; joined to the work's at the end */
    shear_symmetry *terms_before; /* of the same stamps; NULL: none, or estimator is not pdf-sym */
    pthread_mutex_t saving; /* held from making a checkpoint to queueing it; guards the next two */
    size_t terms_saved;     /* of the work's: those that a checkpoint has had */
    int64_t terms_block;    /* ... and the block that they end before */
    shear_unit_size size;
    shear_work *work;
    char checksum[SHEAR_CHECKSUM_SIZE];
    shear_worker **team;      /* [workers], made by each thread when it first comes */
    int64_t checkpoint_block; /* next_block of the last checkpoint */
    int64_t checkpoint_ms;    /* when it was */
    double started_s;
} job;

/* NULL: out of memory; the files are closed. */
job *job_new(const engine_job *spec, engine *e);
void job_free(job *j);

/* ---- under the engine's lock ---- */

/* The job may have something for a worker. */
void job_call_workers(const job *j);
/* Has a job that is being measured nothing left to do, and no worker in it? */
bool job_is_measured(const job *j);

/* ---- job_prepare.c ---- */

/* Open, hash, reserve memory, plan: fills OPENED, FAILED or STOPPED into *event. */
void job_prepare(job *j, engine_event *event);

/* ---- job_measure.c ---- */

/* Make its work, from the checkpoint where there is one, and the rows before it are in the
 * catalog. SHEAR_OK or an error. */
int job_begin(job *j, shear_error *err);
/* One unit of work on behalf of worker thread `slot`; false where nothing is left to do. */
bool job_step(job *j, int slot, shear_error *err);

/* ---- job_result.c ---- */

/* Queue a CHECKPOINT: the sums of all blocks so far, and the terms that the last checkpoint had
 * not; their rows in the catalog are on disk then. Where a file has changed, the work fails. */
void job_save_checkpoint(job *j);
/* All work is over: DONE, FAILED or STOPPED into *event. */
void job_finish(job *j, engine_event *event);
/* The last event of a job that cannot go on for `err`. That a file has changed is the better
 * reason. */
enum engine_event_kind job_failure_event(const job *j, shear_error *err);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job.h: one job in the engine: its reader, plan and work. The engine's lock guards the
 * members from `phase` to `waiting_since`, checkpoint_block and checkpoint_ms; `saving` guards
 * terms_saved and terms_block. The rest belongs to the job's own thread, is not changed while
 * workers use it, or is thread-safe. */
#pragma once

#include "engine/engine.h"
#include "engine/job_files.h"
#include "engine/plan_cache.h"
#include "shear/catalog.h"
#include "shear/run.h"
#include "shear/work.h"

#include <pthread.h>

enum job_phase {
    JOB_PREPARING, /* the job's own thread works on it */
    JOB_OPENED,    /* it waits for engine_go, or begins */
    JOB_MEASURING, /* workers measure it */
    JOB_FINISHING  /* the job's own thread works on it */
};

/* A worker, as a job knows it. The engine's lock guards all but `worker`. */
typedef struct job_seat {
    bool is_member;       /* it has served the job */
    bool entering;        /* it has not yet begun the first read of its work unit */
    shear_worker *worker; /* made by its thread at the first work unit */
} job_seat;

typedef struct job {
    struct job *next; /* in the engine's list */
    engine *engine;
    int64_t id;
    int priority;
    enum job_phase phase;
    bool go, stop_asked;
    atomic_bool stopping; /* copy of stop_asked for the reader, which does not use the lock */
    atomic_int stage;     /* enum engine_stage, for engine_get_progress */
    atomic_llong hashed;  /* bytes hashed so far */
    int64_t bytes;        /* bytes of all files */
    int64_t served;       /* stamps of the work units begun, counted as whole units; for fairness */
    int64_t counted;      /* measured stamps included in the engine's total */
    int holders;          /* workers inside this job */
    int reading;          /* of those, the ones that read or are about to */
    job_seat *seats;      /* [workers] */
    int team_size;        /* most workers that may serve it: memory is reserved for these */
    int members;          /* workers that have served it */
    int64_t reserved;     /* bytes of the budget */
    int64_t waiting_since; /* its ticket while it waits for memory, else 0 */

    job_files files;
    char *catalog_path;
    shear_settings settings;
    reader_limits limits;
    int workers;

    reader *reader;
    const shear_plan *plan; /* the plan cache's; released at the end */
    shear_catalog *catalog;
    int64_t first_block;          /* next_block of the checkpoint it resumes from; 0: none */
    char *sums_before;            /* the checkpoint's sums as text */
    shear_field_sums *before;     /* the same, parsed; added to the work's at the end */
    shear_symmetry *terms_before; /* terms of the same stamps; NULL if there are none */
    pthread_mutex_t saving;       /* held from making a checkpoint to queueing it */
    size_t terms_saved;           /* terms of the work that checkpoints have had */
    int64_t terms_block;          /* first block whose terms no checkpoint has had */
    shear_unit_size size;
    shear_work *work;
    char checksum[SHEAR_CHECKSUM_SIZE];
    int64_t checkpoint_block; /* next_block of the last checkpoint */
    int64_t checkpoint_ms;    /* time of the last checkpoint */
    double started_s;
} job;

/* Create a job. Return NULL if out of memory: the files are closed then, too. */
job *job_new(const engine_job *spec, engine *e);
void job_free(job *j);

/* ---- under the engine's lock ---- */

/* Wake workers: the job may have work. The lock is held. */
void job_call_workers(const job *j);
/* Return whether a job that is being measured has no work left and no worker inside. The lock is
 * held. */
bool job_is_measured(const job *j);

/* ---- job_prepare.c ---- */

/* Open and hash the files, reserve memory and make the plan. *event becomes OPENED, FAILED or
 * STOPPED. */
void job_prepare(job *j, engine_event *event);

/* ---- job_measure.c ---- */

/* Create the job's work, from the checkpoint if there is one and the catalog has the rows before
 * it. Return SHEAR_OK or an error. */
int job_begin(job *j, shear_error *err);
/* Do one work unit on worker thread `slot`. Return false if no work is left. */
bool job_step(job *j, int slot, shear_error *err);

/* ---- job_result.c ---- */

/* Queue a CHECKPOINT: the sums of all blocks so far, and the terms since the last checkpoint. Its
 * rows of the catalog are on disk by then. If a file has changed, the work fails. */
void job_save_checkpoint(job *j);
/* Finish a job whose work has ended: *event becomes DONE, FAILED or STOPPED. */
void job_finish(job *j, engine_event *event);
/* Return the last event of a job that ended with `err`. If a file has changed, that replaces `err`.
 */
enum engine_event_kind job_failure_event(const job *j, shear_error *err);

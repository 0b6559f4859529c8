/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job.h: one job inside the engine: its reader, plan and work. The engine's lock guards
 * `phase` and the members that scheduling needs; the rest belongs to the thread that prepares or
 * finishes the job, or is thread-safe by itself. */
#ifndef SHEARD_ENGINE_JOB_H
#define SHEARD_ENGINE_JOB_H

#include "engine/engine.h"
#include "engine/files.h"
#include "engine/plans.h"
#include "shear/catalog.h"
#include "shear/run.h"
#include "shear/work.h"

enum job_phase {
    JOB_NEW,       /* to be prepared by any worker */
    JOB_PREPARING, /* one worker has it */
    JOB_OPENED,    /* waits for the owner's word */
    JOB_MEASURING, /* workers take turns */
    JOB_FINISHING, /* one worker has it */
    JOB_ENDED
};

typedef struct job {
    struct job *next; /* in the engine's list */
    int64_t id;
    int priority;
    int phase; /* enum job_phase */
    bool stop_asked;
    int64_t served; /* stamps measured, for fairness */
    int holders;    /* threads inside this job's turns, or looking at its work */

    job_files files;
    char *catalogue_path;
    shear_settings settings;
    reader_limits limits;
    int workers;

    reader *reader;
    plans *plans;           /* the engine's */
    const shear_plan *plan; /* theirs; given back at the end */
    shear_catalog *catalogue;
    shear_field_sums *before; /* of the checkpoint; joined to the work's at the end */
    shear_turn_size size;
    shear_work *work;
    char checksum[SHEAR_CHECKSUM_SIZE];
    shear_worker **team;      /* [workers], made by each thread when it first comes */
    int64_t checkpoint_block; /* next_block of the last checkpoint */
    int64_t checkpoint_ms;    /* when it was */
    double started_s;
} job;

/* NULL: out of memory; the files are closed. `kept` outlives the job. */
job *job_new(const engine_job *spec, const engine_options *options, plans *kept);
void job_free(job *j);

/* Hash, open, plan: fills OPENED, or FAILED, into *event. */
void job_prepare(job *j, engine_event *event);
/* Make its work, from the checkpoint where there is one, and the rows before it are in the
 * catalogue. SHEAR_OK or an error. */
int job_begin(job *j, const engine_checkpoint *checkpoint, shear_error *err);
/* One turn on behalf of worker thread `slot`; false where nothing is left to take. */
bool job_step(job *j, int slot, shear_error *err);
/* The sums of all blocks so far, as text, and the next block; their rows in the catalogue are on
 * disk then. Where a file has changed, the work fails. */
int job_checkpoint(job *j, int64_t *next_block, char **sums, shear_error *err);
/* All turns are over: DONE, FAILED or STOPPED into *event. */
void job_finish(job *j, engine_event *event);

double engine_now_s(void); /* monotonic */

#endif

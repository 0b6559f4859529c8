/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_model.h: what daemon/store promises, as plain arrays: no disk, no SQL, every
 * question answered by a walk. */
#pragma once

#include "store/store.h"

enum { MODEL_JOBS = 4000, MODEL_NONE = -1 };

/* Fields, owners, settings, contents and keys are small numbers; MODEL_NONE: not known, or none. */
typedef struct model_job {
    bool kept; /* false: retired */
    int state, outcome, priority, owner, asked, field, settings, content, key;
    bool force, cancel_asked;
    int64_t attempts, failures, interrupted, attempt;
    int64_t started_ms, finished_ms, not_before_ms, duplicate_of;
    int64_t checkpoint; /* its next block; MODEL_NONE: there is none */
} model_job;

typedef struct model_contribution {
    int64_t job;
    int field, settings, content;
} model_contribution;

typedef struct model {
    int64_t max_unfinished;
    int64_t n_jobs; /* ids 1 ... n_jobs */
    model_job jobs[MODEL_JOBS + 1];
    int64_t n_contributions;
    model_contribution contributions[MODEL_JOBS];
    store_totals totals; /* those that are counted in jobs and attempts */
} model;

/* The operations of store.h with the same codes and results. */
int model_submit(model *m, const model_job *spec, int64_t *id, bool *known);
int64_t model_next(model *m, int64_t now_ms);
int model_learn(model *m, int64_t id, int field, int content, int64_t *duplicate_of);
int model_checkpoint(model *m, int64_t id, int64_t next_block);
int model_finish(model *m, int64_t id, bool sums, int64_t now_ms, store_finished *end);
int model_fail(model *m, int64_t id, int failure_class, int64_t retry_at_ms, int64_t now_ms,
               enum store_state *state);
int model_put_back(model *m, int64_t id, bool interrupted, int64_t now_ms, enum store_state *state);
int model_cancel(model *m, int64_t id, int64_t now_ms, enum store_state *state);
int model_retry(model *m, int64_t id);
int model_retract(model *m, int64_t id);
typedef struct model_forgotten {
    int64_t rows, contributions, jobs; /* jobs: that were kept, and are RETRACTED now */
} model_forgotten;
int model_forget(model *m, int field, int settings, model_forgotten *out); /* MODEL_NONE: any */
int64_t model_retire(model *m, const store_retention *rule);
void model_restart(model *m, int64_t now_ms);

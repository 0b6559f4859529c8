/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/job.h: what the operations on one job share. All within the caller's operation. */
#ifndef SHEARD_STORE_JOB_H
#define SHEARD_STORE_JOB_H

#include "store/query.h"

/* The columns that an operation must know before it may change a job. */
typedef struct job_row {
    int64_t id;
    enum store_state state;
    bool cancel_asked, force;
    char *field, *settings_digest, *content; /* field and content may be NULL */
} job_row;

/* STORE_NOT_FOUND where there is no such job. *job is to be deinited in any case. */
int job_row_get(store *s, int64_t id, job_row *job, shear_error *err);
/* The same for a job that must be running: else STORE_WRONG_STATE. */
int job_row_get_running(store *s, int64_t id, job_row *job, shear_error *err);
void job_row_deinit(job_row *job);

int job_wrong_state(const job_row *job, const char *wanted, shear_error *err);

/* Close the attempt of a running job. `why` is NULL unless it failed. */
int job_close_attempt(store *s, int64_t id, enum store_attempt_outcome outcome, int64_t now_ms,
                      const store_failure *why, shear_error *err);
/* Queue a running job again, or cancel it where that was asked. */
int job_put_back(store *s, int64_t id, enum store_attempt_outcome outcome, int64_t now_ms,
                 enum store_state *state, shear_error *err);
/* Cancel an unfinished job. The attempt of a running one must be closed already. */
int job_make_cancelled(store *s, int64_t id, int64_t now_ms, shear_error *err);
/* STORE_QUEUE_FULL where no job may be added to the unfinished ones. */
int job_check_capacity(store *s, int64_t max_unfinished, shear_error *err);

#endif

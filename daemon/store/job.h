/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/job.h: steps that the operations on one job share: read its row, find the job counted with
 * the same identity: field, settings, content. Call them within an operation (operation.h). */
#pragma once

#include "store/query.h"

/* The columns that an operation needs before it changes a job. */
typedef struct job_row {
    int64_t id;
    enum store_state state;
    bool cancel_asked, force;
    char *field, *settings_digest, *content; /* owned; field and content may be NULL */
} job_row;

/* Read the row. STORE_NOT_FOUND if there is no such job. Deinit *job in either case. */
int job_row_get(store *s, int64_t id, job_row *job, shear_error *err);
/* Read the row of a running job; STORE_WRONG_STATE if it does not run. */
int job_row_get_running(store *s, int64_t id, job_row *job, shear_error *err);
void job_row_deinit(job_row *job);

/* The job that was counted with the same identity. */
typedef struct job_match {
    int64_t job; /* the first one; 0: none */
    int64_t n_stamps, n_used;
} job_match;
/* Find the match of a job. A job that is forced, or whose field or content is not known, has none.
 */
int job_find_counted(store *s, const job_row *job, job_match *match, shear_error *err);

int job_missing(int64_t id, shear_error *err); /* Fail with STORE_NOT_FOUND. */
int job_wrong_state(const job_row *job, const char *wanted, shear_error *err);

/* Close the attempt of a running job. `why` is NULL unless it failed. */
int job_close_attempt(store *s, int64_t id, enum store_attempt_outcome outcome, int64_t now_ms,
                      const store_failure *why, shear_error *err);
/* Queue a running job again, or cancel it if that was requested; *state is the result. */
int job_put_back(store *s, int64_t id, enum store_attempt_outcome outcome, int64_t now_ms,
                 enum store_state *state, shear_error *err);
/* Cancel an unfinished job. The attempt of a running job must have been closed. */
int job_make_cancelled(store *s, int64_t id, int64_t now_ms, shear_error *err);
/* Return STORE_QUEUE_FULL if there are `max_unfinished` unfinished jobs or more. */
int job_check_capacity(store *s, int64_t max_unfinished, shear_error *err);

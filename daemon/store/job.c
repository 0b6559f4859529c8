/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/job.h"

#include "base/cleanup.h"
#include "store/operation.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>

void job_row_deinit(job_row *job) {
    free(job->field);
    free(job->settings_digest);
    free(job->content);
    *job = (job_row){0};
}

int job_row_get(store *s, int64_t id, job_row *job, shear_error *err) {
    bool row = false;
    *job = (job_row){.id = id};
    CLEANUP(query_end) query q = query_on(s, SQL_JOB_ROW);
    query_int(&q, id);
    TRY(query_step(&q, &row, err));
    if (!row)
        return shear_fail(err, STORE_NOT_FOUND, NULL, "there is no job %" PRId64, id);
    job->state = (enum store_state)query_get_int(&q);
    job->cancel_asked = query_get_int(&q) != 0;
    job->force = query_get_int(&q) != 0;
    job->field = query_get_text(&q);
    job->settings_digest = query_get_text(&q);
    job->content = query_get_text(&q);
    return query_got(&q, err);
}

int job_wrong_state(const job_row *job, const char *wanted, shear_error *err) {
    return shear_fail(err, STORE_WRONG_STATE, NULL, "job %" PRId64 " is %s, not %s", job->id,
                      store_state_name(job->state), wanted);
}

int job_row_get_running(store *s, int64_t id, job_row *job, shear_error *err) {
    TRY(job_row_get(s, id, job, err));
    return job->state == STORE_RUNNING ? SHEAR_OK : job_wrong_state(job, "running", err);
}

int job_close_attempt(store *s, int64_t id, enum store_attempt_outcome outcome, int64_t now_ms,
                      const store_failure *why, shear_error *err) {
    OPERATION_ASSERT_OPEN(s);
    assert(outcome != STORE_ATTEMPT_OPEN);
    assert((why != NULL) == (outcome == STORE_ATTEMPT_FAILED));
    query q = query_on(s, SQL_ATTEMPT_CLOSE);
    query_int(&q, id);
    query_int(&q, now_ms);
    query_int(&q, outcome);
    query_int(&q, why != NULL ? why->failure_class : STORE_NO_CLASS);
    query_text(&q, why != NULL ? why->code : NULL);
    query_text(&q, why != NULL ? why->message : NULL);
    return query_run(&q, err);
}

int job_make_cancelled(store *s, int64_t id, int64_t now_ms, shear_error *err) {
    OPERATION_ASSERT_OPEN(s);
    query q = query_on(s, SQL_JOB_CANCEL);
    query_int(&q, id);
    query_int(&q, now_ms);
    TRY(query_run(&q, err));
    return query_run_id(s, SQL_CHECKPOINT_DROP, id, err);
}

static int requeue(store *s, int64_t id, bool interrupted, shear_error *err) {
    query q = query_on(s, SQL_REQUEUE);
    query_int(&q, id);
    query_int(&q, interrupted);
    return query_run(&q, err);
}

int job_put_back(store *s, int64_t id, enum store_attempt_outcome outcome, int64_t now_ms,
                 enum store_state *state, shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    *state = STORE_QUEUED;
    TRY(job_row_get_running(s, id, &job, err));
    TRY(job_close_attempt(s, id, outcome, now_ms, NULL, err));
    if (job.cancel_asked) {
        *state = STORE_CANCELLED;
        return job_make_cancelled(s, id, now_ms, err);
    }
    return requeue(s, id, outcome == STORE_ATTEMPT_INTERRUPTED, err);
}

int job_check_capacity(store *s, int64_t max_unfinished, shear_error *err) {
    int64_t unfinished = 0;
    query q = query_on(s, SQL_UNFINISHED);
    const int code = query_number(&q, 0, &unfinished, err);
    if (code != SHEAR_OK || unfinished < max_unfinished)
        return code;
    return shear_fail(err, STORE_QUEUE_FULL, "submit again when jobs have finished",
                      "the queue is full: %" PRId64 " unfinished jobs, the limit is %" PRId64,
                      unfinished, max_unfinished);
}

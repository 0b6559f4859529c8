/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/job.h"

#include "base/cleanup.h"
#include "store/operation.h"
#include "store/row.h"

#include <assert.h>
#include <inttypes.h>

#define MEMBER(member) ROW_MEMBER(job_row, member)
static const row_type job_row_type =
    ROW_TYPE(job_row, MEMBER(state), MEMBER(cancel_asked), MEMBER(force), MEMBER(field),
             MEMBER(settings_digest), MEMBER(content));

void job_row_deinit(job_row *job) {
    row_deinit(&job_row_type, job);
}

int job_missing(int64_t id, shear_error *err) {
    return shear_fail(err, STORE_NOT_FOUND, NULL, "there is no job %" PRId64, id);
}

int job_row_get(store *s, int64_t id, job_row *job, shear_error *err) {
    bool found = false;
    TRY(row_get(QUERY(s, SQL_JOB_ROW, query_int(id)), &job_row_type, job, &found, err));
    job->id = id;
    return found ? SHEAR_OK : job_missing(id, err);
}

#define MATCH(member) ROW_MEMBER(job_match, member)
static const row_type match_type = ROW_TYPE(job_match, MATCH(job), MATCH(n_stamps), MATCH(n_used));

int job_find_counted(store *s, const job_row *job, job_match *match, shear_error *err) {
    *match = (job_match){0};
    if (job->force || job->field == NULL || job->content == NULL)
        return SHEAR_OK;
    return row_get(QUERY(s, SQL_COUNTED_FIND, query_text(job->field),
                         query_text(job->settings_digest), query_text(job->content)),
                   &match_type, match, NULL, err);
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
    static const store_failure none = {.failure_class = STORE_NO_CLASS};
    const store_failure *f = why != NULL ? why : &none;
    return query_run(QUERY(s, SQL_ATTEMPT_CLOSE, query_int(id), query_int(now_ms),
                           query_int(outcome), query_int(f->failure_class), query_text(f->code),
                           query_text(f->message)),
                     err);
}

int job_make_cancelled(store *s, int64_t id, int64_t now_ms, shear_error *err) {
    OPERATION_ASSERT_OPEN(s);
    TRY(query_run(QUERY(s, SQL_JOB_CANCEL, query_int(id), query_int(now_ms)), err));
    return query_run_id(s, SQL_CHECKPOINT_DROP, id, err);
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
    const bool interrupted = outcome == STORE_ATTEMPT_INTERRUPTED;
    return query_run(QUERY(s, SQL_REQUEUE, query_int(id), query_int(interrupted)), err);
}

int job_check_capacity(store *s, int64_t max_unfinished, shear_error *err) {
    int64_t unfinished = 0;
    TRY(query_number(query_on(s, SQL_UNFINISHED), 0, &unfinished, err));
    if (unfinished < max_unfinished)
        return SHEAR_OK;
    return shear_fail(err, STORE_QUEUE_FULL, "submit again when jobs have finished",
                      "the queue is full: %" PRId64 " unfinished jobs, the limit is %" PRId64,
                      unfinished, max_unfinished);
}

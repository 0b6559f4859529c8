/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/job.h"

#include <inttypes.h>
#include <stdlib.h>

void job_row_deinit(job_row *b) {
    free(b->field);
    free(b->settings_digest);
    free(b->content);
    *b = (job_row){0};
}

int job_row_get(store *s, int64_t id, job_row *b, shear_error *err) {
    bool row = false;
    *b = (job_row){.id = id};
    query q = query_on(s, SQL_JOB_ROW);
    query_int(&q, id);
    int code = query_step(&q, &row, err);
    if (row) {
        b->state = (enum store_state)query_get_int(&q);
        b->cancel_asked = query_get_int(&q) != 0;
        b->force = query_get_int(&q) != 0;
        b->field = query_get_text(&q);
        b->settings_digest = query_get_text(&q);
        b->content = query_get_text(&q);
        code = query_got(&q, err);
    } else if (code == SHEAR_OK) {
        code = shear_fail(err, STORE_NOT_FOUND, NULL, "there is no job %" PRId64, id);
    }
    query_end(&q);
    return code;
}

int job_wrong_state(const job_row *b, const char *wanted, shear_error *err) {
    return shear_fail(err, STORE_WRONG_STATE, NULL, "job %" PRId64 " is %s, not %s", b->id,
                      store_state_name(b->state), wanted);
}

int job_row_get_running(store *s, int64_t id, job_row *b, shear_error *err) {
    const int code = job_row_get(s, id, b, err);
    return code == SHEAR_OK && b->state != STORE_RUNNING ? job_wrong_state(b, "running", err)
                                                         : code;
}

int job_close_attempt(store *s, int64_t id, int ending, int64_t now_ms, const store_failure *why,
                      shear_error *err) {
    query q = query_on(s, SQL_ATTEMPT_CLOSE);
    query_int(&q, id);
    query_int(&q, now_ms);
    query_int(&q, ending);
    query_int(&q, why != NULL ? why->failure_class : STORE_NO_CLASS);
    query_text(&q, why != NULL ? why->code : NULL);
    query_text(&q, why != NULL ? why->message : NULL);
    return query_run(&q, err);
}

int job_make_cancelled(store *s, int64_t id, int64_t now_ms, shear_error *err) {
    query q = query_on(s, SQL_JOB_CANCEL);
    query_int(&q, id);
    query_int(&q, now_ms);
    const int code = query_run(&q, err);
    return code == SHEAR_OK ? query_run_id(s, SQL_CHECKPOINT_DROP, id, err) : code;
}

static int requeue(store *s, int64_t id, bool interrupted, shear_error *err) {
    query q = query_on(s, SQL_REQUEUE);
    query_int(&q, id);
    query_int(&q, interrupted);
    return query_run(&q, err);
}

int job_put_back(store *s, int64_t id, int ending, int64_t now_ms, enum store_state *state,
                 shear_error *err) {
    job_row b;
    *state = STORE_QUEUED;
    int code = job_row_get_running(s, id, &b, err);
    if (code == SHEAR_OK) {
        code = job_close_attempt(s, id, ending, now_ms, NULL, err);
    }
    if (code == SHEAR_OK) {
        *state = b.cancel_asked ? STORE_CANCELLED : STORE_QUEUED;
        code = b.cancel_asked ? job_make_cancelled(s, id, now_ms, err)
                              : requeue(s, id, ending == STORE_ATTEMPT_INTERRUPTED, err);
    }
    job_row_deinit(&b);
    return code;
}

int job_check_room(store *s, int64_t max_unfinished, shear_error *err) {
    bool row = false;
    query q = query_on(s, SQL_UNFINISHED);
    const int code = query_step(&q, &row, err);
    const int64_t unfinished = row ? query_get_int(&q) : 0;
    query_end(&q);
    if (code != SHEAR_OK) {
        return code;
    }
    return unfinished < max_unfinished
               ? SHEAR_OK
               : shear_fail(err, STORE_QUEUE_FULL, "submit again when jobs have finished",
                            "the queue is full: %" PRId64 " unfinished jobs, the limit is %" PRId64,
                            unfinished, max_unfinished);
}

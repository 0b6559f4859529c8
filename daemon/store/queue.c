/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Start the next job, and end a running one without a result: failed, released, cancelled. */
#include "base/text.h"

#include "base/cleanup.h"
#include "store/job.h"
#include "store/operation.h"
#include "store/query.h"

static int start(store *s, int64_t id, int64_t now_ms, shear_error *err) {
    const parameter job = query_int(id);
    TRY(query_run(QUERY(s, SQL_START, job, query_int(now_ms)), err));
    TRY(query_run(QUERY(s, SQL_ATTEMPT_OPEN, job, query_int(now_ms)), err));
    return query_run(QUERY(s, SQL_ATTEMPT_PRUNE, job, query_int(STORE_ATTEMPTS_KEPT)), err);
}

static int next(store *s, int64_t now_ms, store_job *job, shear_error *err) {
    int64_t id = 0;
    TRY(query_run_id(s, SQL_WAKE, now_ms, err));
    TRY(query_number(query_on(s, SQL_NEXT), 0, &id, err));
    if (id == 0)
        return SHEAR_OK;
    TRY(start(s, id, now_ms, err));
    return store_job_get(s, id, job, err);
}

int store_next(store *s, int64_t now_ms, store_job *job, shear_error *err) {
    *job = (store_job){0};
    const int code = OPERATION(s, next(s, now_ms, job, err), err);
    if (code != SHEAR_OK)
        store_job_deinit(job);
    return code;
}

int store_next_due(store *s, int64_t *due_ms, shear_error *err) {
    return query_number(query_on(s, SQL_DUE), INT64_MAX, due_ms, err);
}

static int set_clock(store *s, const store_clock *c, shear_error *err) {
    TRY(query_run(QUERY(s, SQL_WAITING_SHIFT, query_int(c->delta_ms), query_int(c->latest_ms)),
                  err));
    return query_run_id(s, SQL_FINISHED_CLAMP, c->now_ms, err);
}

int store_set_clock(store *s, const store_clock *clock, shear_error *err) {
    return OPERATION(s, set_clock(s, clock, err), err);
}

int store_waiting_reasons(store *s, store_waiting *reasons, size_t capacity, size_t *n,
                          shear_error *err) {
    bool row = false;
    CLEANUP(query_end) query q = QUERY(s, SQL_WAITING_REASONS, query_int((int64_t)capacity));
    int code = query_step(&q, &row, err);
    for (*n = 0; row && *n < capacity; (*n)++) {
        store_waiting *w = &reasons[*n];
        text_set(w->code, sizeof w->code, query_peek_text(&q));
        w->jobs = query_get_int(&q);
        w->attempts = query_get_int(&q);
        w->next_ms = query_get_int(&q);
        text_set(w->message, sizeof w->message, query_peek_text(&q));
        code = query_step(&q, &row, err);
    }
    *n = code == SHEAR_OK ? *n : 0;
    return code;
}

int store_retry_waiting(store *s, const char *failure, int64_t now_ms, shear_error *err) {
    return OPERATION(
        s, query_run(QUERY(s, SQL_RETRY_WAITING, query_int(now_ms), query_text(failure)), err),
        err);
}

static int check_failure(const store_failure *f, shear_error *err) {
    const text_rule rules[] = {{"failure's code", f->code, STORE_CODE_MAX, false},
                               {"failure's message", f->message, STORE_MESSAGE_MAX, false},
                               {"failure's advice", f->advice, STORE_ADVICE_MAX, true}};
    if (f->failure_class <= STORE_NO_CLASS || f->failure_class > STORE_BUG) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "a failure has no class %d", (int)f->failure_class);
    }
    return query_check_texts(rules, sizeof rules / sizeof rules[0], err);
}

static int write_failure(store *s, int64_t id, const store_failure *f, enum store_state state,
                         shear_error *err) {
    const bool waits = state == STORE_WAITING;
    return query_run(QUERY(s, SQL_JOB_FAIL, query_int(id), query_int(state),
                           query_int(waits ? f->retry_at_ms : 0), query_int(waits ? 0 : f->now_ms),
                           query_int(f->failure_class), query_text(f->code), query_text(f->message),
                           query_text(f->advice)),
                     err);
}

static int fail(store *s, int64_t id, const store_failure *f, enum store_state *state,
                shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    TRY(job_row_get_running(s, id, &job, err));
    TRY(job_close_attempt(s, id, STORE_ATTEMPT_FAILED, f->now_ms, f, err));
    *state = job.cancel_asked      ? STORE_CANCELLED
             : f->retry_at_ms >= 0 ? STORE_WAITING
                                   : STORE_FAILED;
    TRY(write_failure(s, id, f, *state, err));
    return *state == STORE_CANCELLED ? query_run_id(s, SQL_CHECKPOINT_DROP, id, err) : SHEAR_OK;
}

/* Return `code`; on error reset *state. */
static int keep_state(int code, enum store_state *state) {
    *state = code == SHEAR_OK ? *state : STORE_QUEUED;
    return code;
}

int store_fail(store *s, int64_t id, const store_failure *failure, enum store_state *state,
               shear_error *err) {
    *state = STORE_QUEUED;
    TRY(check_failure(failure, err));
    return keep_state(OPERATION(s, fail(s, id, failure, state, err), err), state);
}

int store_release(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err) {
    return keep_state(
        OPERATION(s, job_put_back(s, id, STORE_ATTEMPT_RELEASED, now_ms, state, err), err), state);
}

static int cancel(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    TRY(job_row_get(s, id, &job, err));
    switch (job.state) {
    case STORE_QUEUED:
    case STORE_WAITING:
        *state = STORE_CANCELLED;
        return job_make_cancelled(s, id, now_ms, err);
    case STORE_RUNNING:
        *state = STORE_RUNNING;
        return query_run_id(s, SQL_JOB_ASK_CANCEL, id, err);
    case STORE_CANCELLED:
        *state = STORE_CANCELLED;
        return SHEAR_OK;
    default:
        return job_wrong_state(&job, "unfinished", err);
    }
}

int store_cancel(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err) {
    return keep_state(OPERATION(s, cancel(s, id, now_ms, state, err), err), state);
}

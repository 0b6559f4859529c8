/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read a job and its attempts. */
#include "store/row.h"

#include "base/cleanup.h"
#include "store/job.h"

#include <stdlib.h>

#define JOB(member) ROW_MEMBER(store_job, member)
static const row_type job_type =
    ROW_TYPE(store_job, JOB(id), JOB(state), JOB(outcome), JOB(origin), JOB(priority), JOB(force),
             JOB(cancel_asked), JOB(owner), JOB(attempts), JOB(failures), JOB(interrupted),
             JOB(attempt), JOB(created_ms), JOB(started_ms), JOB(finished_ms), JOB(not_before_ms),
             JOB(n_stamps), JOB(n_used), JOB(elapsed_us), JOB(duplicate_of), JOB(failure_class),
             JOB(gid), JOB(field), JOB(source), JOB(settings), JOB(settings_digest), JOB(key),
             JOB(content), JOB(code), JOB(message), JOB(advice), JOB(result), JOB(catalog),
             JOB(groups), JOB(dropped), JOB(place), JOB(place_fingerprint));

void store_job_deinit(store_job *job) {
    row_deinit(&job_type, job);
}

int store_job_get(store *s, int64_t id, store_job *job, shear_error *err) {
    bool found = false;
    TRY(row_get(QUERY(s, SQL_JOB_GET, query_int(id)), &job_type, job, &found, err));
    return found ? SHEAR_OK : job_missing(id, err);
}

int store_job_state(store *s, int64_t id, enum store_state *state, shear_error *err) {
    enum { NO_ROW = -1 };
    int64_t number = NO_ROW;
    TRY(query_number(QUERY(s, SQL_JOB_STATE, query_int(id)), NO_ROW, &number, err));
    if (number == NO_ROW)
        return job_missing(id, err);
    *state = (enum store_state)number;
    return SHEAR_OK;
}

#define ATTEMPT(member) ROW_MEMBER(store_attempt, member)
static const row_type attempt_type =
    ROW_TYPE(store_attempt, ATTEMPT(number), ATTEMPT(started_ms), ATTEMPT(ended_ms),
             ATTEMPT(outcome), ATTEMPT(failure_class), ATTEMPT(code), ATTEMPT(message));

void store_attempts_deinit(store_attempts *list) {
    row_free(&attempt_type, list->attempts, list->n);
    *list = (store_attempts){0};
}

int store_attempts_get(store *s, int64_t id, store_attempts *list, shear_error *err) {
    enum store_state state;
    bool more = false;
    *list = (store_attempts){0};
    TRY(store_job_state(s, id, &state, err));
    list->attempts = calloc(STORE_ATTEMPTS_KEPT, sizeof *list->attempts);
    if (list->attempts == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for attempts");
    int code = row_list(QUERY(s, SQL_ATTEMPTS, query_int(id)), &attempt_type, STORE_ATTEMPTS_KEPT,
                        list->attempts, &list->n, &more, err);
    if (code != SHEAR_OK)
        store_attempts_deinit(list);
    return code;
}

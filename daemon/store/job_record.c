/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read a job and its attempts. */
#include "store/query.h"

#include "base/cleanup.h"

#include <inttypes.h>
#include <stdlib.h>

static void read_numbers(query *q, store_job *job) {
    job->id = query_get_int(q);
    job->state = (enum store_state)query_get_int(q);
    job->outcome = (enum store_outcome)query_get_int(q);
    job->origin = (enum store_origin)query_get_int(q);
    job->priority = (int)query_get_int(q);
    job->force = query_get_int(q) != 0;
    job->cancel_asked = query_get_int(q) != 0;
    job->owner = (uint32_t)query_get_int(q);
    job->attempts = query_get_int(q);
    job->failures = query_get_int(q);
    job->interrupted = query_get_int(q);
    job->attempt = query_get_int(q);
    job->created_ms = query_get_int(q);
    job->started_ms = query_get_int(q);
    job->finished_ms = query_get_int(q);
    job->not_before_ms = query_get_int(q);
    job->n_stamps = query_get_int(q);
    job->n_used = query_get_int(q);
    job->elapsed_us = query_get_int(q);
    job->duplicate_of = query_get_int(q);
    job->failure_class = (enum store_class)query_get_int(q);
    job->gid = (uint32_t)query_get_int(q);
}

static void read_texts(query *q, store_job *job) {
    job->field = query_get_text(q);
    job->source = query_get_text(q);
    job->settings = query_get_text(q);
    job->settings_digest = query_get_text(q);
    job->key = query_get_text(q);
    job->content = query_get_text(q);
    job->code = query_get_text(q);
    job->message = query_get_text(q);
    job->advice = query_get_text(q);
    job->result = query_get_text(q);
    job->catalog = query_get_text(q);
    job->groups = query_get_text(q);
    job->dropped = query_get_text(q);
    job->place = query_get_text(q);
    job->place_fingerprint = query_get_text(q);
}

void store_job_deinit(store_job *job) {
    char *const texts[] = {
        job->field,   job->source, job->settings, job->settings_digest, job->key,
        job->content, job->code,   job->message,  job->advice,          job->result,
        job->catalog, job->groups, job->dropped,  job->place,           job->place_fingerprint};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        free(texts[i]);
    *job = (store_job){0};
}

static int no_job(int64_t id, shear_error *err) {
    return shear_fail(err, STORE_NOT_FOUND, NULL, "there is no job %" PRId64, id);
}

int store_job_get(store *s, int64_t id, store_job *job, shear_error *err) {
    bool row = false;
    *job = (store_job){0};
    CLEANUP(query_end) query q = query_on(s, SQL_JOB_GET);
    query_int(&q, id);
    TRY(query_step(&q, &row, err));
    if (!row)
        return no_job(id, err);
    read_numbers(&q, job);
    read_texts(&q, job);
    int code = query_got(&q, err);
    if (code != SHEAR_OK)
        store_job_deinit(job);
    return code;
}

int store_job_state(store *s, int64_t id, enum store_state *state, shear_error *err) {
    enum { NO_ROW = -1 };
    int64_t number = NO_ROW;
    query q = query_on(s, SQL_JOB_STATE);
    query_int(&q, id);
    TRY(query_number(&q, NO_ROW, &number, err));
    if (number == NO_ROW)
        return no_job(id, err);
    *state = (enum store_state)number;
    return SHEAR_OK;
}

void store_attempts_deinit(store_attempts *list) {
    for (size_t i = 0; i < list->n; i++) {
        free(list->attempts[i].code);
        free(list->attempts[i].message);
    }
    free(list->attempts);
    *list = (store_attempts){0};
}

static void read_attempt(query *q, store_attempt *a) {
    a->number = query_get_int(q);
    a->started_ms = query_get_int(q);
    a->ended_ms = query_get_int(q);
    a->outcome = (enum store_attempt_outcome)query_get_int(q);
    a->failure_class = (enum store_class)query_get_int(q);
    a->code = query_get_text(q);
    a->message = query_get_text(q);
}

static int read_attempts(store *s, int64_t id, store_attempts *list, shear_error *err) {
    bool row = false;
    CLEANUP(query_end) query q = query_on(s, SQL_ATTEMPTS);
    query_int(&q, id);
    for (;;) {
        int code = query_step(&q, &row, err);
        if (!row || list->n == STORE_ATTEMPTS_KEPT)
            return code;
        read_attempt(&q, &list->attempts[list->n++]);
        TRY(query_got(&q, err));
    }
}

int store_attempts_get(store *s, int64_t id, store_attempts *list, shear_error *err) {
    enum store_state state;
    *list = (store_attempts){0};
    TRY(store_job_state(s, id, &state, err));
    list->attempts = calloc(STORE_ATTEMPTS_KEPT, sizeof *list->attempts);
    if (list->attempts == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for attempts");
    int code = read_attempts(s, id, list, err);
    if (code != SHEAR_OK)
        store_attempts_deinit(list);
    return code;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How what was counted is taken back: exactly, for the sums are integers. */
#include "store/identity.h"
#include "store/operation.h"
#include "store/query.h"
#include "store/sums_text.h"

#include "shear/sums.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct counted {
    int64_t id, field; /* id 0: the job has no contribution */
    int64_t n_stamps, n_used, counted_ms;
    int64_t jobs; /* of the field, this one among them; 0: it is gone (store_forget) */
    char *packed, *field_packed;
} counted;

static int find_counted(store *s, int64_t job, counted *c, shear_error *err) {
    bool row = false;
    *c = (counted){0};
    query q = query_on(s, SQL_CONTRIBUTION_OF);
    query_int(&q, job);
    int code = query_step(&q, &row, err);
    if (row) {
        c->id = query_get_int(&q);
        c->field = query_get_int(&q);
        c->n_stamps = query_get_int(&q);
        c->n_used = query_get_int(&q);
        c->counted_ms = query_get_int(&q);
        c->jobs = query_get_int(&q);
        c->packed = query_get_text(&q);
        c->field_packed = query_get_text(&q);
        code = query_got(&q, err);
    }
    query_end(&q);
    return code;
}

static int parse_packed(const char *packed, shear_field_sums **sums, shear_error *err) {
    char *text = NULL;
    *sums = NULL;
    int code = sums_unpack(packed, &text, err);
    if (code == SHEAR_OK) {
        code = shear_field_sums_parse(sums, text, err);
    }
    free(text);
    return code;
}

/* The field's sums without the contribution's, which has gone. */
static int subtract(store *s, const counted *c, char **packed, shear_error *err) {
    shear_influence top;
    shear_field_sums *field = NULL;
    shear_field_sums *one = NULL;
    char *text = NULL;
    *packed = NULL;
    int code = parse_packed(c->field_packed, &field, err);
    if (code == SHEAR_OK) {
        code = parse_packed(c->packed, &one, err);
    }
    if (code == SHEAR_OK) {
        code = field_top(s, c->field, &top, NULL, err);
    }
    if (code == SHEAR_OK) {
        shear_field_sums_leave(field, one);
        shear_field_sums_set_top(field, top);
        code = shear_field_sums_format(field, &text, err);
    }
    if (code == SHEAR_OK) {
        code = sums_pack(text, packed, err);
    }
    shear_field_sums_free(field);
    shear_field_sums_free(one);
    free(text);
    return code;
}

static int leave_field(store *s, const counted *c, shear_error *err) {
    char *packed = NULL;
    if (c->jobs == 0) {
        return SHEAR_OK;
    }
    if (c->jobs == 1) {
        return query_run_id(s, SQL_FIELD_DROP, c->field, err);
    }
    int code = subtract(s, c, &packed, err);
    if (code == SHEAR_OK) {
        query q = query_on(s, SQL_FIELD_LEAVE);
        query_int(&q, c->field);
        query_text(&q, packed);
        query_int(&q, c->n_stamps);
        query_int(&q, c->n_used);
        query_int(&q, c->counted_ms);
        code = query_run(&q, err);
    }
    free(packed);
    return code;
}

static int check_counted(const store_job *job, shear_error *err) {
    if (job->state == STORE_DONE && job->outcome == STORE_DUPLICATE) {
        return shear_fail(err, STORE_WRONG_STATE, "retract that job instead",
                          "job %" PRId64 " was not counted: it is a duplicate of job %" PRId64,
                          job->id, job->duplicate_of);
    }
    if (job->state != STORE_DONE) {
        return shear_fail(err, STORE_WRONG_STATE, NULL,
                          "job %" PRId64 " is %s: only what was counted can be retracted", job->id,
                          store_state_name(job->state));
    }
    return SHEAR_OK;
}

static int retract(store *s, int64_t id, shear_error *err) {
    store_job job;
    counted c = {0};
    int code = store_job_get(s, id, &job, err);
    const bool retracted = code == SHEAR_OK && job.state == STORE_RETRACTED;
    if (code == SHEAR_OK && !retracted) {
        code = check_counted(&job, err);
    }
    if (code != SHEAR_OK || retracted) {
        store_job_deinit(&job);
        return code;
    }
    code = find_counted(s, id, &c, err);
    if (code == SHEAR_OK && c.id == 0) {
        code = shear_fail(err, SHEAR_E_FORMAT, "restore the database from a copy",
                          "job %" PRId64 " was counted, and has no contribution", id);
    }
    if (code == SHEAR_OK) {
        code = query_run_id(s, SQL_CONTRIBUTION_DROP, c.id, err);
    }
    if (code == SHEAR_OK) {
        code = leave_field(s, &c, err);
    }
    if (code == SHEAR_OK) {
        code = query_run_id(s, SQL_JOB_RETRACT, id, err);
    }
    free(c.packed);
    free(c.field_packed);
    store_job_deinit(&job);
    return code;
}

int store_retract(store *s, int64_t id, shear_error *err) {
    const int code = operation_begin(s, err);
    return code == SHEAR_OK ? operation_end(s, retract(s, id, err), err) : code;
}

/* ---- catalogs that are to go ---- */

int store_next_leftover(store *s, int64_t after, int64_t *id, char **path, shear_error *err) {
    bool row = false;
    query q = query_on(s, SQL_LEFTOVER);
    query_int(&q, after);
    int code = query_step(&q, &row, err);
    *id = row ? query_get_int(&q) : 0;
    *path = row ? query_get_text(&q) : NULL;
    if (row) {
        code = query_got(&q, err);
    }
    query_end(&q);
    *id = code == SHEAR_OK ? *id : 0;
    return code;
}

int store_catalog_gone(store *s, int64_t id, shear_error *err) {
    const int code = operation_begin(s, err);
    return code == SHEAR_OK ? operation_end(s, query_run_id(s, SQL_CATALOG_GONE, id, err), err)
                            : code;
}

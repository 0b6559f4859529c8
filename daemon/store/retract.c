/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retract a job's contribution: exact, because the sums are integers. */
#include "store/field_row.h"

#include "base/cleanup.h"
#include "store/operation.h"
#include "store/row.h"
#include "store/sums_text.h"

#include <inttypes.h>

typedef struct counted {
    int64_t id, field;
    int64_t n_stamps, n_used, counted_ms;
    int64_t jobs; /* of the field, including this one; 0: the field was forgotten */
    char *packed, *field_packed;
} counted;

#define COUNTED(member) ROW_MEMBER(counted, member)
static const row_type counted_type =
    ROW_TYPE(counted, COUNTED(id), COUNTED(field), COUNTED(n_stamps), COUNTED(n_used),
             COUNTED(counted_ms), COUNTED(jobs), COUNTED(packed), COUNTED(field_packed));

static void counted_deinit(counted *c) {
    row_deinit(&counted_type, c);
}

static int find_counted(store *s, int64_t job, counted *c, shear_error *err) {
    bool found = false;
    TRY(row_get(QUERY(s, SQL_CONTRIBUTION_OF, query_int(job)), &counted_type, c, &found, err));
    if (found)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_FORMAT, "restore the database from a copy",
                      "job %" PRId64 " was counted, and has no contribution", job);
}

/* Compute the field's sums without the contribution, which has been removed. */
static int subtract(store *s, const counted *c, char **packed, shear_error *err) {
    shear_influence top;
    CLEANUP(shear_field_sums_release) shear_field_sums *field = NULL;
    CLEANUP(shear_field_sums_release) shear_field_sums *one = NULL;
    TRY(sums_parse_packed(&field, c->field_packed, err));
    TRY(sums_parse_packed(&one, c->packed, err));
    TRY(field_row_top(s, c->field, &top, NULL, err));
    shear_field_sums_subtract(field, one);
    shear_field_sums_set_top(field, top);
    return sums_format_packed(field, packed, err);
}

static int leave_field(store *s, const counted *c, shear_error *err) {
    CLEANUP(release_free) char *packed = NULL;
    if (c->jobs == 0)
        return SHEAR_OK;
    if (c->jobs == 1)
        return query_run_id(s, SQL_FIELD_DROP, c->field, err);
    TRY(subtract(s, c, &packed, err));
    return query_run(QUERY(s, SQL_FIELD_LEAVE, query_int(c->field), query_text(packed),
                           query_int(c->n_stamps), query_int(c->n_used), query_int(c->counted_ms)),
                     err);
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

/* Remove what a done job contributed. */
static int retract_counted(store *s, int64_t id, shear_error *err) {
    CLEANUP(counted_deinit) counted c = {0};
    TRY(find_counted(s, id, &c, err));
    TRY(query_run_id(s, SQL_CONTRIBUTION_DROP, c.id, err));
    TRY(leave_field(s, &c, err));
    return query_run_id(s, SQL_JOB_RETRACT, id, err);
}

static int retract(store *s, int64_t id, shear_error *err) {
    CLEANUP(store_job_deinit) store_job job = {0};
    TRY(store_job_get(s, id, &job, err));
    if (job.state == STORE_RETRACTED)
        return SHEAR_OK;
    TRY(check_counted(&job, err));
    return retract_counted(s, id, err);
}

int store_retract(store *s, int64_t id, shear_error *err) {
    return OPERATION(s, retract(s, id, err), err);
}

/* ---- catalogs that are to be removed ---- */

int store_next_leftover(store *s, int64_t after, int64_t *id, char **path, shear_error *err) {
    bool row = false;
    *id = 0;
    *path = NULL;
    CLEANUP(query_end) query q = QUERY(s, SQL_LEFTOVER, query_int(after));
    int code = query_step(&q, &row, err);
    if (!row)
        return code;
    const int64_t found = query_get_int(&q);
    *path = query_get_text(&q);
    code = query_got(&q, err);
    *id = code == SHEAR_OK ? found : 0;
    return code;
}

int store_catalog_gone(store *s, int64_t id, shear_error *err) {
    return OPERATION(s, query_run_id(s, SQL_CATALOG_GONE, id, err), err);
}

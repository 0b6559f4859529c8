/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finish a job: store its result and its contribution to the field in one operation. */
#include "store/field_row.h"

#include "base/cleanup.h"
#include "store/job.h"
#include "store/operation.h"
#include "store/sums_text.h"
#include "store/terms.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* A job's sums in the three forms that are needed: parsed, packed, and as numbers. */
typedef struct job_sums {
    shear_field_sums *sums; /* NULL: not given */
    char *packed;
    int64_t n_stamps, n_used;
} job_sums;

static void job_sums_deinit(job_sums *j) {
    shear_field_sums_free(j->sums);
    free(j->packed);
}

static int job_sums_init(job_sums *j, const store_work *w, shear_error *err) {
    shear_result result;
    *j = (job_sums){0};
    if (w->sums == NULL)
        return SHEAR_OK;
    TRY(sums_parse_given(&j->sums, w->sums, err));
    TRY(terms_check(w->terms, w->terms_size, err));
    shear_field_result(j->sums, &result);
    j->n_stamps = result.n_stamps;
    j->n_used = result.n_used;
    return sums_pack(w->sums, &j->packed, err);
}

static int add_field(store *s, const job_row *job, const job_sums *j, int64_t now_ms, int64_t *id,
                     shear_error *err) {
    TRY(query_run(QUERY(s, SQL_FIELD_ADD, query_text(job->field), query_text(job->settings_digest),
                        query_text(j->packed), query_int(j->n_stamps), query_int(j->n_used),
                        query_int(now_ms)),
                  err));
    *id = sqlite3_last_insert_rowid(s->db);
    return SHEAR_OK;
}

/* Join a field's packed sums and a job's exactly; *packed is malloc'd. */
static int join(const char *field_packed, const job_sums *j, char **packed, shear_error *err) {
    CLEANUP(shear_field_sums_release) shear_field_sums *sums = NULL;
    TRY(sums_parse_packed(&sums, field_packed, err));
    shear_field_sums_join(sums, j->sums);
    return sums_format_packed(sums, packed, err);
}

static int join_field(store *s, const field_row *field, const job_sums *j, int64_t now_ms,
                      shear_error *err) {
    CLEANUP(release_free) char *packed = NULL;
    TRY(join(field->packed, j, &packed, err));
    return query_run(QUERY(s, SQL_FIELD_JOIN, query_int(field->id), query_text(packed),
                           query_int(j->n_stamps), query_int(j->n_used), query_int(now_ms)),
                     err);
}

static int add_contribution(store *s, const job_row *job, int64_t field, const job_sums *j,
                            const store_work *w, shear_error *err) {
    const shear_influence top = shear_field_sums_top(j->sums);
    return query_run(QUERY(s, SQL_CONTRIBUTION_ADD, query_int(field), query_int(job->id),
                           query_text(job->content), query_text(j->packed), query_int(j->n_stamps),
                           query_int(j->n_used), query_int(w->now_ms), query_int(w->elapsed_us),
                           query_text(w->account), query_real(w->has_truth ? w->true_g1 : NAN),
                           query_real(w->has_truth ? w->true_g2 : NAN), query_real(top.size),
                           query_int(top.stamp)),
                     err);
}

static int count(store *s, const job_row *job, const job_sums *j, const store_work *w,
                 shear_error *err) {
    CLEANUP(field_row_deinit) field_row field = {0};
    OPERATION_ASSERT_OPEN(s);
    assert(job->field != NULL && job->content != NULL && j->sums != NULL);
    TRY(field_row_get(s, job->field, job->settings_digest, &field, err));
    TRY(field.id == 0 ? add_field(s, job, j, w->now_ms, &field.id, err)
                      : join_field(s, &field, j, w->now_ms, err));
    TRY(add_contribution(s, job, field.id, j, w, err));
    return w->terms != NULL ? terms_add_contribution(s, w->terms, w->terms_size, err) : SHEAR_OK;
}

static int write_done(store *s, int64_t id, const store_work *w, const store_finished *end,
                      const job_match *m, shear_error *err) {
    TRY(query_run(QUERY(s, SQL_JOB_DONE, query_int(id), query_int(end->outcome),
                        query_int(end->duplicate_of), query_int(m->n_stamps), query_int(m->n_used),
                        query_int(w->elapsed_us), query_int(w->now_ms), query_text(w->result),
                        query_text(w->catalog)),
                  err));
    return query_run_id(s, SQL_CHECKPOINT_DROP, id, err);
}

/* Store the outcome. A duplicate's row shows the numbers of the job that was counted. */
static int finish_done(store *s, const job_row *job, const store_work *w, const job_sums *j,
                       store_finished *end, shear_error *err) {
    job_match m;
    TRY(job_find_counted(s, job, &m, err));
    *end = (store_finished){STORE_DONE, m.job != 0 ? STORE_DUPLICATE : STORE_COUNTED, m.job};
    if (m.job == 0) {
        if (j->sums == NULL) {
            return shear_fail(err, STORE_WRONG_STATE, NULL,
                              "job %" PRId64 " is no duplicate: it cannot finish without sums",
                              job->id);
        }
        m = (job_match){0, j->n_stamps, j->n_used};
        TRY(count(s, job, j, w, err));
    }
    TRY(job_close_attempt(s, job->id, STORE_ATTEMPT_DONE, w->now_ms, NULL, err));
    return write_done(s, job->id, w, end, &m, err);
}

static int finish_cancelled(store *s, const job_row *job, const store_work *w, store_finished *end,
                            shear_error *err) {
    *end = (store_finished){.state = STORE_CANCELLED};
    TRY(job_close_attempt(s, job->id, STORE_ATTEMPT_CANCELLED, w->now_ms, NULL, err));
    return job_make_cancelled(s, job->id, w->now_ms, err);
}

static int finish(store *s, int64_t id, const store_work *w, const job_sums *j, store_finished *end,
                  shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    TRY(job_row_get_running(s, id, &job, err));
    if (job.cancel_asked)
        return finish_cancelled(s, &job, w, end, err);
    if (job.field == NULL || job.content == NULL) {
        return shear_fail(err, STORE_WRONG_STATE, NULL,
                          "job %" PRId64 ": its field and content must be known at its end", id);
    }
    return finish_done(s, &job, w, j, end, err);
}

int store_finish(store *s, int64_t id, const store_work *work, store_finished *end,
                 shear_error *err) {
    const text_rule rules[] = {{"result", work->result, STORE_RESULT_MAX, true},
                               {"account", work->account, STORE_ACCOUNT_MAX, true},
                               {"catalog's path", work->catalog, STORE_PATH_MAX, true}};
    CLEANUP(job_sums_deinit) job_sums j = {0};
    *end = (store_finished){0};
    TRY(query_check_texts(rules, sizeof rules / sizeof rules[0], err));
    TRY(job_sums_init(&j, work, err));
    int code = OPERATION(s, finish(s, id, work, &j, end, err), err);
    if (code != SHEAR_OK)
        *end = (store_finished){0};
    return code;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A job's end: it and its contribution to its field in one operation. */
#include "store/identity.h"
#include "store/job.h"
#include "store/operation.h"
#include "store/sums_text.h"
#include "store/terms.h"

#include "shear/sums.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* A job's sums in the three forms that are needed. */
typedef struct job_sums {
    shear_field_sums *sums; /* NULL: not given */
    char *packed;
    int64_t n_stamps, n_used;
    const unsigned char *terms; /* the caller's; or NULL */
    size_t terms_size;
} job_sums;

static void job_sums_deinit(job_sums *j) {
    shear_field_sums_free(j->sums);
    free(j->packed);
}

static int job_sums_init(job_sums *j, const store_work *w, shear_error *err) {
    shear_result result;
    *j = (job_sums){.terms = w->terms, .terms_size = w->terms_size};
    if (w->sums == NULL) {
        return SHEAR_OK;
    }
    int code = sums_parse_given(&j->sums, w->sums, err);
    if (code == SHEAR_OK) {
        code = terms_check(w->terms, w->terms_size, err);
    }
    if (code == SHEAR_OK) {
        shear_field_result(j->sums, &result);
        j->n_stamps = result.n_stamps;
        j->n_used = result.n_used;
        code = sums_pack(w->sums, &j->packed, err);
    }
    return code;
}

/* The field's row: its id (0: there is none yet) and packed sums (the caller's). */
static int find_field(store *s, const job_row *b, int64_t *id, char **packed, shear_error *err) {
    bool row = false;
    *id = 0;
    *packed = NULL;
    query q = query_on(s, SQL_FIELD_FIND);
    query_text(&q, b->field);
    query_text(&q, b->settings_digest);
    int code = query_step(&q, &row, err);
    if (row) {
        *id = query_get_int(&q);
        *packed = query_get_text(&q);
        code = query_got(&q, err);
    }
    query_end(&q);
    return code;
}

static int add_field(store *s, const job_row *b, const job_sums *j, int64_t now_ms, int64_t *id,
                     shear_error *err) {
    query q = query_on(s, SQL_FIELD_ADD);
    query_text(&q, b->field);
    query_text(&q, b->settings_digest);
    query_text(&q, j->packed);
    query_int(&q, j->n_stamps);
    query_int(&q, j->n_used);
    query_int(&q, now_ms);
    const int code = query_run(&q, err);
    *id = sqlite3_last_insert_rowid(s->db);
    return code;
}

/* The packed text of a field's sums and a job's, exactly joined. */
static int join(const char *field_packed, const job_sums *j, char **packed, shear_error *err) {
    char *text = NULL;
    char *joined = NULL;
    shear_field_sums *sums = NULL;
    *packed = NULL;
    int code = sums_unpack(field_packed, &text, err);
    if (code == SHEAR_OK) {
        code = shear_field_sums_parse(&sums, text, err);
    }
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, j->sums);
        code = shear_field_sums_format(sums, &joined, err);
    }
    if (code == SHEAR_OK) {
        code = sums_pack(joined, packed, err);
    }
    shear_field_sums_free(sums);
    free(joined);
    free(text);
    return code;
}

static int join_field(store *s, int64_t field, const char *field_packed, const job_sums *j,
                      int64_t now_ms, shear_error *err) {
    char *packed = NULL;
    int code = join(field_packed, j, &packed, err);
    if (code == SHEAR_OK) {
        query q = query_on(s, SQL_FIELD_JOIN);
        query_int(&q, field);
        query_text(&q, packed);
        query_int(&q, j->n_stamps);
        query_int(&q, j->n_used);
        query_int(&q, now_ms);
        code = query_run(&q, err);
    }
    free(packed);
    return code;
}

static int add_contribution(store *s, const job_row *b, int64_t field, const job_sums *j,
                            const store_work *w, shear_error *err) {
    query q = query_on(s, SQL_CONTRIBUTION_ADD);
    query_int(&q, field);
    query_int(&q, b->id);
    query_text(&q, b->content);
    query_text(&q, j->packed);
    query_int(&q, j->n_stamps);
    query_int(&q, j->n_used);
    query_int(&q, w->now_ms);
    query_int(&q, w->elapsed_us);
    query_text(&q, w->account);
    query_real(&q, w->true_g1, !w->has_truth);
    query_real(&q, w->true_g2, !w->has_truth);
    const shear_influence top = shear_field_sums_top(j->sums);
    query_real(&q, top.size, isnan(top.size));
    query_int(&q, top.stamp);
    return query_run(&q, err);
}

static int count(store *s, const job_row *b, const job_sums *j, const store_work *w,
                 shear_error *err) {
    int64_t field = 0;
    char *packed = NULL;
    int code = find_field(s, b, &field, &packed, err);
    if (code == SHEAR_OK && field == 0) {
        code = add_field(s, b, j, w->now_ms, &field, err);
    } else if (code == SHEAR_OK) {
        code = join_field(s, field, packed, j, w->now_ms, err);
    }
    if (code == SHEAR_OK) {
        code = add_contribution(s, b, field, j, w, err);
    }
    if (code == SHEAR_OK && j->terms != NULL) {
        code = terms_count(s, j->terms, j->terms_size, err);
    }
    free(packed);
    return code;
}

static int write_done(store *s, int64_t id, const store_work *w, const store_finished *end,
                      const identity_match *m, shear_error *err) {
    query q = query_on(s, SQL_JOB_DONE);
    query_int(&q, id);
    query_int(&q, end->outcome);
    query_int(&q, end->duplicate_of);
    query_int(&q, m->n_stamps);
    query_int(&q, m->n_used);
    query_int(&q, w->elapsed_us);
    query_int(&q, w->now_ms);
    query_text(&q, w->result);
    query_text(&q, w->catalog);
    const int code = query_run(&q, err);
    return code == SHEAR_OK ? query_run_id(s, SQL_CHECKPOINT_DROP, id, err) : code;
}

/* The numbers that the job's row shows: the first job's where this one is its duplicate. */
static int finish_done(store *s, const job_row *b, const store_work *w, const job_sums *j,
                       store_finished *end, shear_error *err) {
    identity_match m = {0};
    int code =
        b->force ? SHEAR_OK : identity_find(s, b->field, b->settings_digest, b->content, &m, err);
    if (code != SHEAR_OK) {
        return code;
    }
    *end = (store_finished){STORE_DONE, m.job != 0 ? STORE_DUPLICATE : STORE_COUNTED, m.job};
    if (m.job == 0) {
        if (j->sums == NULL) {
            return shear_fail(err, STORE_WRONG_STATE, NULL,
                              "job %" PRId64 " is no duplicate: it cannot finish without sums",
                              b->id);
        }
        m = (identity_match){0, j->n_stamps, j->n_used};
        code = count(s, b, j, w, err);
    }
    if (code == SHEAR_OK) {
        code = job_close_attempt(s, b->id, STORE_ATTEMPT_DONE, w->now_ms, NULL, err);
    }
    return code == SHEAR_OK ? write_done(s, b->id, w, end, &m, err) : code;
}

static int finish_cancelled(store *s, const job_row *b, const store_work *w, store_finished *end,
                            shear_error *err) {
    *end = (store_finished){.state = STORE_CANCELLED};
    const int code = job_close_attempt(s, b->id, STORE_ATTEMPT_CANCELLED, w->now_ms, NULL, err);
    return code == SHEAR_OK ? job_make_cancelled(s, b->id, w->now_ms, err) : code;
}

static int finish(store *s, int64_t id, const store_work *w, const job_sums *j, store_finished *end,
                  shear_error *err) {
    job_row b;
    int code = job_row_get_running(s, id, &b, err);
    if (code == SHEAR_OK && b.cancel_asked) {
        code = finish_cancelled(s, &b, w, end, err);
    } else if (code == SHEAR_OK && (b.field == NULL || b.content == NULL)) {
        code = shear_fail(err, STORE_WRONG_STATE, NULL,
                          "job %" PRId64 ": its field and content must be known at its end", id);
    } else if (code == SHEAR_OK) {
        code = finish_done(s, &b, w, j, end, err);
    }
    job_row_deinit(&b);
    return code;
}

static int check_work(const store_work *w, shear_error *err) {
    int code = query_check_text("result", w->result, STORE_RESULT_MAX, true, err);
    if (code == SHEAR_OK) {
        code = query_check_text("account", w->account, STORE_ACCOUNT_MAX, true, err);
    }
    return code == SHEAR_OK
               ? query_check_text("catalog's path", w->catalog, STORE_PATH_MAX, true, err)
               : code;
}

int store_finish(store *s, int64_t id, const store_work *work, store_finished *end,
                 shear_error *err) {
    job_sums j = {0};
    *end = (store_finished){0};
    int code = check_work(work, err);
    if (code == SHEAR_OK) {
        code = job_sums_init(&j, work, err);
    }
    if (code == SHEAR_OK) {
        code = operation_begin(s, err);
        if (code == SHEAR_OK) {
            code = operation_end(s, finish(s, id, work, &j, end, err), err);
        }
    }
    if (code != SHEAR_OK) {
        *end = (store_finished){0};
    }
    job_sums_deinit(&j);
    return code;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a running job learns on its way: its input's identity, and its sums so far. */
#include "store/identity.h"
#include "store/job.h"
#include "store/operation.h"
#include "store/sums_text.h"
#include "store/terms.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static int write_learned(store *s, int64_t id, const store_input *l, shear_error *err) {
    query q = query_on(s, SQL_JOB_SET_INPUT);
    query_int(&q, id);
    query_text(&q, l->field);
    query_text(&q, l->content);
    query_int(&q, l->n_stamps);
    return query_run(&q, err);
}

static int learn(store *s, int64_t id, const store_input *l, int64_t *duplicate_of,
                 shear_error *err) {
    job_row b;
    identity_match match = {0};
    int code = job_row_get_running(s, id, &b, err);
    if (code == SHEAR_OK) {
        code = write_learned(s, id, l, err);
    }
    const bool changed =
        b.content != NULL && l->content != NULL && strcmp(b.content, l->content) != 0;
    if (code == SHEAR_OK && changed) {
        code = query_run_id(s, SQL_CHECKPOINT_DROP, id, err);
    }
    job_row_deinit(&b);
    if (code == SHEAR_OK) {
        code = job_row_get(s, id, &b, err);
    }
    if (code == SHEAR_OK && !b.force) {
        code = identity_find(s, b.field, b.settings_digest, b.content, &match, err);
    }
    *duplicate_of = match.job;
    job_row_deinit(&b);
    return code;
}

int store_set_input(store *s, int64_t id, const store_input *learned, int64_t *duplicate_of,
                    shear_error *err) {
    *duplicate_of = 0;
    int code = query_check_text("field's name", learned->field, STORE_FIELD_MAX, true, err);
    if (code == SHEAR_OK) {
        code = query_check_text("content checksum", learned->content, STORE_DIGEST_MAX, true, err);
    }
    if (code == SHEAR_OK) {
        code = operation_begin(s, err);
    }
    if (code != SHEAR_OK) {
        return code;
    }
    code = operation_end(s, learn(s, id, learned, duplicate_of, err), err);
    *duplicate_of = code == SHEAR_OK ? *duplicate_of : 0;
    return code;
}

/* Refuse now what a resumed job could not go on with. */
static int check_checkpoint(int64_t id, const store_progress *p, shear_error *err) {
    shear_field_sums *parsed = NULL;
    if (p->from_block < 0 || p->next_block < p->from_block) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "job %" PRId64 ": a checkpoint of blocks %" PRId64 " to %" PRId64, id,
                          p->from_block, p->next_block);
    }
    const int code = sums_parse_given(&parsed, p->sums, err);
    shear_field_sums_free(parsed);
    return code == SHEAR_OK ? terms_check(p->terms, p->terms_size, err) : code;
}

static int write_checkpoint(store *s, int64_t id, const store_progress *p, const char *packed,
                            shear_error *err) {
    job_row b;
    int code = job_row_get_running(s, id, &b, err);
    if (code == SHEAR_OK && b.content == NULL) {
        code = shear_fail(err, STORE_WRONG_STATE, NULL,
                          "job %" PRId64 ": its content must be known before a checkpoint", id);
    }
    if (code == SHEAR_OK) {
        query q = query_on(s, SQL_CHECKPOINT_SET);
        query_int(&q, id);
        query_int(&q, p->next_block);
        query_text(&q, packed);
        code = query_run(&q, err);
    }
    if (code == SHEAR_OK && p->terms != NULL) {
        code = terms_save(s, id, p, err);
    }
    job_row_deinit(&b);
    return code;
}

int store_checkpoint_terms(store *s, int64_t id, const store_progress *progress, shear_error *err) {
    char *packed = NULL;
    int code = check_checkpoint(id, progress, err);
    if (code == SHEAR_OK) {
        code = sums_pack(progress->sums, &packed, err);
    }
    if (code == SHEAR_OK) {
        code = operation_begin(s, err);
        if (code == SHEAR_OK) {
            code = operation_end(s, write_checkpoint(s, id, progress, packed, err), err);
        }
    }
    free(packed);
    return code;
}

int store_checkpoint(store *s, int64_t id, int64_t next_block, const char *sums, shear_error *err) {
    const store_progress progress = {.next_block = next_block, .sums = sums};
    return store_checkpoint_terms(s, id, &progress, err);
}

int store_checkpoint_load(store *s, int64_t id, int64_t *next_block, char **sums,
                          shear_error *err) {
    bool row = false;
    char *packed = NULL;
    *next_block = 0;
    *sums = NULL;
    query q = query_on(s, SQL_CHECKPOINT_GET);
    query_int(&q, id);
    int code = query_step(&q, &row, err);
    const int64_t block = row ? query_get_int(&q) : 0;
    if (row) {
        packed = query_get_text(&q);
        code = query_got(&q, err);
    } else if (code == SHEAR_OK) {
        code = shear_fail(err, STORE_NOT_FOUND, NULL, "job %" PRId64 " has no checkpoint", id);
    }
    query_end(&q);
    if (code == SHEAR_OK) {
        code = sums_unpack(packed, sums, err);
    }
    *next_block = code == SHEAR_OK ? block : 0;
    free(packed);
    return code;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checkpoints: the sums of a running job so far. */
#include "store/job.h"

#include "base/cleanup.h"
#include "store/operation.h"
#include "store/sums_text.h"
#include "store/terms.h"

#include <inttypes.h>

/* Refuse a checkpoint from which a job could not resume. */
static int check_checkpoint(int64_t id, const store_progress *p, shear_error *err) {
    CLEANUP(shear_field_sums_release) shear_field_sums *parsed = NULL;
    if (p->from_block < 0 || p->next_block < p->from_block) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "job %" PRId64 ": a checkpoint of blocks %" PRId64 " to %" PRId64, id,
                          p->from_block, p->next_block);
    }
    TRY(sums_parse_given(&parsed, p->sums, err));
    return terms_check(p->terms, p->terms_size, err);
}

static int write_checkpoint(store *s, int64_t id, const store_progress *p, const char *packed,
                            shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    TRY(job_row_get_running(s, id, &job, err));
    if (job.content == NULL) {
        return shear_fail(err, STORE_WRONG_STATE, NULL,
                          "job %" PRId64 ": its content must be known before a checkpoint", id);
    }
    TRY(query_run(
        QUERY(s, SQL_CHECKPOINT_SET, query_int(id), query_int(p->next_block), query_text(packed)),
        err));
    return p->terms != NULL ? terms_add_checkpoint(s, id, p, err) : SHEAR_OK;
}

int store_checkpoint(store *s, int64_t id, const store_progress *progress, shear_error *err) {
    CLEANUP(release_free) char *packed = NULL;
    TRY(check_checkpoint(id, progress, err));
    TRY(sums_pack(progress->sums, &packed, err));
    return OPERATION(s, write_checkpoint(s, id, progress, packed, err), err);
}

int store_checkpoint_load(store *s, int64_t id, int64_t *next_block, char **sums,
                          shear_error *err) {
    bool row = false;
    *next_block = 0;
    *sums = NULL;
    CLEANUP(query_end) query q = QUERY(s, SQL_CHECKPOINT_GET, query_int(id));
    TRY(query_step(&q, &row, err));
    if (!row)
        return shear_fail(err, STORE_NOT_FOUND, NULL, "job %" PRId64 " has no checkpoint", id);
    const int64_t block = query_get_int(&q);
    CLEANUP(release_free) char *packed = query_get_text(&q);
    TRY(query_got(&q, err));
    TRY(sums_unpack(packed, sums, err));
    *next_block = block;
    return SHEAR_OK;
}

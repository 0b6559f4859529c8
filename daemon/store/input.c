/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Store what a running job found in its input. */
#include "store/job.h"

#include "base/cleanup.h"
#include "store/operation.h"

#include <string.h>

/* Update the input; drop a checkpoint that belongs to another content. */
static int update(store *s, int64_t id, const store_input *input, shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    TRY(job_row_get_running(s, id, &job, err));
    TRY(query_run(QUERY(s, SQL_JOB_SET_INPUT, query_int(id), query_text(input->field),
                        query_text(input->content), query_int(input->n_stamps)),
                  err));
    const bool changed =
        job.content != NULL && input->content != NULL && strcmp(job.content, input->content) != 0;
    return changed ? query_run_id(s, SQL_CHECKPOINT_DROP, id, err) : SHEAR_OK;
}

static int set_input(store *s, int64_t id, const store_input *input, int64_t *duplicate_of,
                     shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    job_match match;
    TRY(update(s, id, input, err));
    TRY(job_row_get(s, id, &job, err));
    TRY(job_find_counted(s, &job, &match, err));
    *duplicate_of = match.job;
    return SHEAR_OK;
}

int store_set_input(store *s, int64_t id, const store_input *input, int64_t *duplicate_of,
                    shear_error *err) {
    const text_rule rules[] = {{"field's name", input->field, STORE_FIELD_MAX, true},
                               {"content checksum", input->content, STORE_DIGEST_MAX, true}};
    *duplicate_of = 0;
    TRY(query_check_texts(rules, sizeof rules / sizeof rules[0], err));
    int code = OPERATION(s, set_input(s, id, input, duplicate_of, err), err);
    *duplicate_of = code == SHEAR_OK ? *duplicate_of : 0;
    return code;
}

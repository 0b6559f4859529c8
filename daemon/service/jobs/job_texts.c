/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_texts.h"

#include "sheard/account.h"
#include "sheard/advice.h"

#include <stdlib.h>
#include <string.h>

static char *account_text(const sheard_report_file *file) {
    char *text = NULL;
    shear_error ignored;
    if (sheard_account_format(&text, file, &ignored) == SHEAR_OK &&
        strlen(text) > STORE_ACCOUNT_MAX) {
        free(text);
        text = NULL;
    }
    return text;
}

static char *result_text(const active_job *j, const engine_event *e,
                         const sheard_report_file *file) {
    char *text = NULL;
    shear_error ignored;
    sheard_advice_list advice;
    sheard_advice_all(&advice, &e->result, &j->plan, NULL);
    const sheard_report report = {.field = j->field,
                                  .result = &e->result,
                                  .settings = &j->settings,
                                  .plan = &j->plan,
                                  .files = file,
                                  .n_files = 1,
                                  .top_file = e->result.top_stamp >= 0 ? file->path : NULL,
                                  .has_truth = j->info.has_truth,
                                  .true_g1 = j->info.sim_g1,
                                  .true_g2 = j->info.sim_g2,
                                  .warnings = advice.lines,
                                  .n_warnings = advice.n,
                                  .seconds = e->seconds};
    sheard_report_json(&text, &report, &ignored);
    return text;
}

void job_texts_init(job_texts *texts, const active_job *j, const engine_event *e) {
    const sheard_report_file file = {.path = j->path,
                                     .checksum = j->checksum,
                                     .field = j->info.name,
                                     .n_stamps = e->result.n_stamps,
                                     .n_used = e->result.n_used,
                                     .plan = &j->plan,
                                     .seconds = e->seconds};
    *texts = (job_texts){.result = result_text(j, e, &file), .account = account_text(&file)};
}

void job_texts_deinit(job_texts *texts) {
    free(texts->result);
    free(texts->account);
    *texts = (job_texts){0};
}

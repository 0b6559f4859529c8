/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_texts.h: the texts that the store keeps for a measured job. */
#pragma once

#include "service/jobs/active_jobs.h"

typedef struct job_texts {
    char *result; /* report of its file alone; NULL: out of memory */
    /* Account of its file, stored with the contribution; NULL: out of memory, or longer than
     * STORE_ACCOUNT_MAX. The field's report then knows less of this file. */
    char *account;
} job_texts;

/* Make the texts from the job's event DONE. */
void job_texts_init(job_texts *texts, const active_job *j, const engine_event *e);
void job_texts_deinit(job_texts *texts);

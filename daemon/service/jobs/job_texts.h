/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_texts.h: what the store keeps as texts of a job that was measured. */
#ifndef SHEARD_SERVICE_JOB_TEXTS_H
#define SHEARD_SERVICE_JOB_TEXTS_H

#include "service/jobs/active_jobs.h"

typedef struct job_texts {
    char *result;  /* the report of its file alone */
    char *account; /* of its file, kept with the contribution; NULL: there is no memory for it, or
                      it would be too long: then the field's report knows less of this file */
} job_texts;

/* Of its event DONE. NULL where memory is out. */
void job_texts_init(job_texts *texts, const active_job *j, const engine_event *e);
void job_texts_deinit(job_texts *texts);

#endif

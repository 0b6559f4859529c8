/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_outcome.h: how the attempts of jobs end: why they failed, when they are tried
 * again, and who is told. */
#ifndef SHEARD_SERVICE_JOB_OUTCOME_H
#define SHEARD_SERVICE_JOB_OUTCOME_H

#include "shear/error.h"
#include "store/store.h"

typedef struct service service;

typedef struct failure_reason {
    enum store_class class;
    const char *name; /* stable code */
} failure_reason;

/* What an error of the library, the reader or the engine means for a job. */
failure_reason job_outcome_reason(const shear_error *error);
/* The attempt failed: to be tried again, or for good. `failures`: of this job before. */
void job_outcome_fail(service *s, int64_t id, int64_t failures, failure_reason reason,
                      const shear_error *error);
/* The job's new state is in this group: tell it when that is on disk. */
void job_outcome_settle(service *s, int64_t id);
/* The job is final, on disk, and its file is where it belongs: those who waited for it are
 * answered. */
void job_outcome_tell(service *s, const store_job *job);

#endif

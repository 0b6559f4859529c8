/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_outcome.h: how attempts of jobs end: why they fail, when they are tried again
 * (a full disk), and the notifications that follow. */
#pragma once

#include "shear/error.h"
#include "store/store.h"

typedef struct service service;

typedef struct failure_reason {
    enum store_class class;
    const char *name; /* stable code */
} failure_reason;

/* Classify an error of the library, the reader or the engine. */
failure_reason job_outcome_reason(const shear_error *error);
/* Store that an attempt failed, and when the job is tried again, if at all. `failures` counts the
 * job's earlier failures. */
void job_outcome_fail(service *s, int64_t id, int64_t failures, failure_reason reason,
                      const shear_error *error);
/* Register what follows when the job's new state, which is in this group, is on disk: move its
 * file, answer clients, publish. */
void job_outcome_settle(service *s, int64_t id);
/* Answer the clients that wait for a job that is final, on disk, and whose file has been moved. */
void job_outcome_tell(service *s, const store_job *job);

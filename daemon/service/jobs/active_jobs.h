/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/active_jobs.h: the jobs that this process works on. */
#pragma once

#include "engine/engine.h"
#include "store/store.h"

typedef struct service service;

typedef struct active_job {
    struct active_job *next;
    int64_t id;
    int64_t failures;                  /* attempts that failed so far, for the back-off */
    int64_t started_ms;                /* steady clock */
    char *path;                        /* for messages */
    char *field;                       /* requested, or from the file; NULL: not known yet */
    char digest[STORE_DIGEST_MAX + 1]; /* of its settings */
    shear_settings settings;
    char checksum[SHEAR_CHECKSUM_SIZE]; /* "": not known yet */
    shear_field_info info;
    shear_plan_info plan;
    int64_t failed_commits; /* value of the group's counter when the input was stored */
    bool ended;             /* its outcome is in the store: ignore the engine's last event */
} active_job;

typedef struct active_jobs {
    active_job *first;
    size_t n;
    int64_t ended;         /* since the start */
    size_t marked;         /* marked running in the store, not on disk yet and so not started */
    bool may_have_orphans; /* jobs may be running in the store on which nothing works */
} active_jobs;

void active_jobs_deinit(active_jobs *all);

/* Make the record of a job whose files are not open yet. SHEAR_E_NOMEM, SHEAR_E_INTERNAL. */
int active_job_new(active_job **out, const store_job *job, shear_error *err);
void active_job_free(active_job *j);

void active_jobs_add(active_jobs *all, active_job *j);      /* takes ownership */
active_job *active_jobs_find(active_jobs *all, int64_t id); /* NULL: not found */
void active_jobs_remove(active_jobs *all, active_job *j);   /* and frees it */

/* Return true if the job is under way and belongs to this field with these settings (`digest` NULL:
 * any). */
bool active_job_is_of(const active_job *j, const char *field, const char *digest);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/active_jobs.h: the jobs that this process works on. */
#ifndef SHEARD_SERVICE_ACTIVE_JOBS_H
#define SHEARD_SERVICE_ACTIVE_JOBS_H

#include "engine/engine.h"
#include "store/store.h"

typedef struct service service;

typedef struct active_job {
    struct active_job *next;
    int64_t id;
    int64_t failures;   /* so far, for the back-off */
    int64_t started_ms; /* steady clock */
    char *path;         /* for messages */
    char *field;        /* asked for, or learned from the file; NULL: not known yet */
    char *digest;       /* of its settings */
    shear_settings settings;
    char checksum[SHEAR_CHECKSUM_SIZE]; /* "": not known yet */
    shear_field_info info;
    shear_plan_info plan;
    int64_t failed_commits; /* as the group's when the store was told of its content */
    bool ended;             /* the engine's last event of it needs no more attention */
} active_job;

/* Whom the jobs concern in the rooms above; set once, at the start. What they are told is on disk.
 */
typedef struct job_hooks {
    /* Where the job is final: its file, if it has one, goes to done/ or failed/, and *job says
     * where it is. */
    void (*dispose_file)(service *s, store_job *job);
    /* The job is final, and its file where it belongs: answer those who waited for it. */
    void (*ended)(service *s, const store_job *job);
    /* The job counts in its field from now on. */
    void (*counted)(service *s, const store_job *job);
    /* An event of the engine about none of the store's jobs. */
    void (*other_event)(service *s, const engine_event *e);
} job_hooks;

typedef struct active_jobs {
    active_job *first;
    size_t n;
    const job_hooks *hooks;
    int64_t ended;         /* since the start */
    size_t marked;         /* running in the store, and not started before that is on disk */
    bool may_have_orphans; /* jobs may be running on disk that nobody works on */
} active_jobs;

void active_jobs_deinit(active_jobs *all);

/* The job as it is known before its files are open. SHEAR_E_NOMEM, SHEAR_E_INTERNAL. */
int active_job_new(active_job **out, const store_job *job, shear_error *err);
void active_job_free(active_job *j);

void active_jobs_add(active_jobs *all, active_job *j);      /* takes it over */
active_job *active_jobs_find(active_jobs *all, int64_t id); /* NULL: there is none */
void active_jobs_remove(active_jobs *all, active_job *j);   /* and free it */

/* Is it of this field, with these settings (NULL: any), and under way? */
bool active_job_is_of(const active_job *j, const char *field, const char *digest);

#endif

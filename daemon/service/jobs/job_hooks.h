/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_hooks.h: whom the jobs concern in the rooms above; set once, at the start. What
 * they are told is on disk. */
#ifndef SHEARD_SERVICE_JOB_HOOKS_H
#define SHEARD_SERVICE_JOB_HOOKS_H

#include "engine/engine.h"
#include "store/store.h"

typedef struct service service;

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

#endif

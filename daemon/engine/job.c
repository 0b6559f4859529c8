/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/job.h"

#include "base/clock.h"
#include "engine/budget.h"
#include "engine/internal.h"

#include <stdlib.h>
#include <string.h>

static bool allocate(job *j, const engine_job *spec) {
    j->catalog_path = spec->catalog != NULL ? strdup(spec->catalog) : NULL;
    j->seats = calloc((size_t)j->workers, sizeof *j->seats);
    return j->seats != NULL && (spec->catalog == NULL || j->catalog_path != NULL);
}

job *job_new(const engine_job *spec, engine *e) {
    const engine_options *options = &e->options;
    job *j = calloc(1, sizeof *j);
    job_files files;
    const bool acquired = job_files_acquire(&files, spec->input, spec->fds);
    if (j == NULL) {
        job_files_close(&files);
        return NULL;
    }
    *j = (job){.engine = e,
               .id = spec->id,
               .priority = spec->priority,
               .settings = spec->settings,
               .limits = options->limits,
               .workers = options->workers,
               .files = files,
               .bytes = job_files_bytes(&files),
               .started_s = clock_s(CLOCK_MONOTONIC)};
    pthread_mutex_init(&j->saving, NULL);
    j->limits.stop = &j->stopping;
    if (!acquired || !allocate(j, spec)) {
        job_free(j);
        return NULL;
    }
    return j;
}

void job_free(job *j) {
    if (j == NULL)
        return;
    assert(j->holders == 0);
    for (int i = 0; j->seats != NULL && i < j->workers; i++)
        shear_worker_free(j->seats[i].worker);
    free(j->seats);
    free(j->sums_before);
    shear_work_free(j->work);
    reader_stop(j->reader);
    shear_catalog_suspend(j->catalog); /* kept for the next attempt, if there is one */
    shear_field_sums_free(j->before);
    shear_symmetry_free(j->terms_before);
    pthread_mutex_destroy(&j->saving);
    budget_return(j);
    job_files_close(&j->files);
    free(j->catalog_path);
    free(j);
}

void job_call_workers(const job *j) {
    engine *e = j->engine;
    ENGINE_ASSERT_LOCKED(e);
    /* Waking one worker is enough, unless it may be one that the job has no memory for. */
    if (j->team_size < j->workers) {
        pthread_cond_broadcast(&e->work_available);
    } else {
        pthread_cond_signal(&e->work_available);
    }
}

bool job_is_measured(const job *j) {
    ENGINE_ASSERT_LOCKED(j->engine);
    assert(j->holders >= 0);
    return j->holders == 0 && shear_work_get_status(j->work).exhausted;
}

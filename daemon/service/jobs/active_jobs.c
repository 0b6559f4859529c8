/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/active_jobs.h"

#include "base/text.h"
#include "service/core/clock.h"
#include "sheard/messages.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void active_jobs_deinit(active_jobs *all) {
    while (all->first != NULL)
        active_jobs_remove(all, all->first);
}

void active_job_free(active_job *j) {
    if (j == NULL)
        return;
    free(j->path);
    free(j->field);
    free(j);
}

int active_job_new(active_job **out, const store_job *job, shear_error *err) {
    active_job *j = calloc(1, sizeof *j);
    *out = NULL;
    if (j == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    *j = (active_job){.id = job->id,
                      .failures = job->failures,
                      .started_ms = clock_steady_ms(),
                      .field = job->field != NULL ? strdup(job->field) : NULL};
    text_set(j->digest, sizeof j->digest, job->settings_digest);
    if (sheard_settings_read(&j->settings, job->settings, err) != SHEAR_OK) {
        active_job_free(j);
        err->code = SHEAR_E_INTERNAL; /* the settings were valid when they were stored */
        return SHEAR_E_INTERNAL;
    }
    *out = j;
    return SHEAR_OK;
}

void active_jobs_add(active_jobs *all, active_job *j) {
    assert(active_jobs_find(all, j->id) == NULL);
    j->next = all->first;
    all->first = j;
    all->n++;
}

active_job *active_jobs_find(active_jobs *all, int64_t id) {
    active_job *j = all->first;
    while (j != NULL && j->id != id)
        j = j->next;
    return j;
}

void active_jobs_remove(active_jobs *all, active_job *j) {
    active_job **at = &all->first;
    while (*at != j) {
        assert(*at != NULL);
        at = &(*at)->next;
    }
    *at = j->next;
    all->n--;
    active_job_free(j);
}

bool active_job_is_of(const active_job *j, const char *field, const char *digest) {
    return !j->ended && j->field != NULL && strcmp(j->field, field) == 0 &&
           (digest == NULL || strcmp(j->digest, digest) == 0);
}

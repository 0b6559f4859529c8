/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The jobs that this process works on: from the queue into the engine. */
#include "service/inner.h"
#include "service/jobs/job_source.h"

#include <stdlib.h>
#include <string.h>

active_job *jobs_find(service *s, int64_t id) {
    active_job *j = s->active;
    while (j != NULL && j->id != id) {
        j = j->next;
    }
    return j;
}

static void active_free(active_job *j) {
    if (j != NULL) {
        free(j->active_name);
        free(j->path);
        free(j->field);
        free(j->digest);
        free(j);
    }
}

void jobs_forget(service *s, active_job *j) {
    active_job **at = &s->active;
    while (*at != j) {
        at = &(*at)->next;
    }
    *at = j->next;
    s->n_active--;
    active_free(j);
}

/* ---- starting ---- */

/* The job as this process knows it before its files are open. */
static int active_new(active_job **out, const store_job *job, ending_reason *reason,
                      shear_error *err) {
    active_job *j = calloc(1, sizeof *j);
    *out = NULL;
    if (j == NULL) {
        *reason = ending_reason_of(&(shear_error){.code = SHEAR_E_NOMEM});
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    *j = (active_job){.id = job->id,
                      .origin = job->origin,
                      .failures = job->failures,
                      .started_ms = steady_ms(),
                      .field = job->field != NULL ? strdup(job->field) : NULL,
                      .digest = strdup(job->settings_digest)};
    const int code = sheard_settings_read(&j->settings, job->settings, err);
    if (code != SHEAR_OK) { /* they were good when they were stored */
        *reason = ending_reason_of(&(shear_error){.code = SHEAR_E_INTERNAL});
        active_free(j);
        return code;
    }
    *out = j;
    return SHEAR_OK;
}

/* Hand the open files over to the engine. */
static int give(service *s, const store_job *job, active_job *j, source_opened *o,
                shear_error *err) {
    char text[SHEAR_INPUT_TEXT_SIZE];
    char *catalog = catalog_path(s, job->id);
    j->path = strdup(shear_input_text(&o->input, text, sizeof text));
    j->active_name = o->active_name;
    o->active_name = NULL;
    const engine_job spec = {.id = job->id,
                             .priority = job->priority,
                             .input = &o->input,
                             .fds = o->files.fds,
                             .settings = j->settings,
                             .catalog = catalog};
    const int code = engine_add(s->engine, &spec, err);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        o->files.fds[i] = -1; /* the engine's, in any case */
    }
    free(catalog);
    return code;
}

static void start(service *s, const store_job *job) {
    active_job *j = NULL;
    shear_error err = {0};
    ending_reason reason;
    source_opened o = {.files = {.fds = {-1, -1, -1, -1}}};
    int code = active_new(&j, job, &reason, &err);
    if (code == SHEAR_OK) {
        code = source_open_for_job(s, job, &o, &err);
        reason = (ending_reason){o.job_class, o.name};
    }
    if (code == SHEAR_OK) {
        code = give(s, job, j, &o, &err);
        reason = ending_reason_of(&err);
    }
    source_opened_deinit(&o);
    if (code != SHEAR_OK) {
        active_free(j);
        ending_fail(s, job->id, job->failures, reason, &err);
        return;
    }
    j->next = s->active;
    s->active = j;
    s->n_active++;
}

/* Jobs are marked running in this turn's group; they start when that is on disk. */
static void start_marked(service *s, after *a, int code, const shear_error *err) {
    (void)err;
    store_job job = {0};
    shear_error ignored;
    if (code != SHEAR_OK || store_job_get(s->store, a->job, &job, &ignored) != SHEAR_OK) {
        s->strays = true; /* most likely nothing was marked */
        return;
    }
    if (job.state == STORE_RUNNING && jobs_find(s, job.id) == NULL) {
        start(s, &job);
        publish_job(s, &job);
    }
    store_job_deinit(&job);
}

static int marked(const service *s) {
    int n = 0;
    for (const after *a = s->first_after; a != NULL; a = a->next) {
        n += a->run == start_marked;
    }
    return n;
}

/* After the store failed: jobs that are running on disk while nobody works on them, because their
 * end was lost, go back into the queue. */
static void put_back_strays(service *s) {
    const store_job_filter running = {.states = 1u << STORE_RUNNING};
    store_job_page page = {0};
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    int code = store_jobs(s->store, &running, STORE_PAGE_MAX, &page, &err);
    for (size_t i = 0; i < page.n && code == SHEAR_OK; i++) {
        const int64_t id = page.jobs[i].id;
        if (jobs_find(s, id) == NULL) {
            code = group_begin(s, &err);
            code = code == SHEAR_OK ? store_release(s->store, id, wall_ms(), &state, &err) : code;
        }
        if (jobs_find(s, id) == NULL && code == SHEAR_OK) {
            log_notice("job %lld is queued again", (long long)id);
            ending_settle(s, id);
        }
    }
    s->strays = code != SHEAR_OK;
    store_job_page_deinit(&page);
}

void jobs_fill(service *s) {
    shear_error err = {0};
    clock_look(s);
    if (s->strays && s->store_trouble_ms == 0 && marked(s) == 0) {
        put_back_strays(s);
    }
    while (s->state != SHEARD_SERVER_STOPPING && s->store_trouble_ms == 0 &&
           s->n_active + marked(s) < s->config.daemon.max_active_jobs) {
        store_job job = {0};
        int64_t due = 0;
        store_counts counts;
        /* A look before the group is opened: an idle service must not commit. */
        if (store_count(s->store, &counts, &err) != SHEAR_OK ||
            (counts.jobs[STORE_QUEUED] == 0 &&
             (store_next_due(s->store, &due, &err) != SHEAR_OK || due > wall_ms()))) {
            return;
        }
        int code = group_begin(s, &err);
        if (code == SHEAR_OK) {
            code = store_next(s->store, wall_ms(), &job, &err);
        }
        const int64_t id = code == SHEAR_OK ? job.id : 0;
        store_job_deinit(&job);
        after *a = id != 0 ? group_after(s, start_marked) : NULL;
        if (a == NULL) {
            return;
        }
        a->job = id;
    }
}

void jobs_stop_all(service *s) {
    for (active_job *j = s->active; j != NULL; j = j->next) {
        engine_stop_job(s->engine, j->id);
    }
}

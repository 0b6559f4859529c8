/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_queue.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_outcome.h"
#include "service/jobs/job_source.h"

#include <assert.h>
#include <inttypes.h>
#include <string.h>

/* ---- starting ---- */

/* Pass the open files to the engine. */
static int give(service *s, const store_job *job, active_job *j, job_source *o, shear_error *err) {
    char text[SHEAR_INPUT_TEXT_SIZE];
    CLEANUP(release_free) char *catalog = catalog_path(s, job->id);
    j->path = strdup(shear_input_text(&o->input, text, sizeof text));
    const engine_job spec = {.id = job->id,
                             .priority = job->priority,
                             .input = &o->input,
                             .fds = o->files.fds,
                             .settings = j->settings,
                             .catalog = catalog};
    const int code = engine_add(s->engine, &spec, err);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        o->files.fds[i] = -1; /* the engine owns it now, also on error */
    }
    return code;
}

static void start(service *s, const store_job *job) {
    CLEANUP(job_source_deinit) job_source o = {.files = SOURCE_FILES_NONE};
    active_job *j = NULL;
    shear_error err = {0};
    int code = active_job_new(&j, job, &err);
    code = code == SHEAR_OK ? job_source_open(s, job, &o, &err) : code;
    code = code == SHEAR_OK ? give(s, job, j, &o, &err) : code;
    if (code == SHEAR_OK) {
        active_jobs_add(s->jobs, j);
        return;
    }
    active_job_free(j);
    job_outcome_fail(s, job->id, job->failures,
                     o.reason.name != NULL ? o.reason : job_outcome_reason(&err), &err);
}

static void start_marked(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    (void)err;
    assert(s->jobs->marked > 0);
    s->jobs->marked--;
    if (code != SHEAR_OK || store_job_get(s->store, post->job, &job, &ignored) != SHEAR_OK) {
        s->jobs->may_have_orphans = true; /* probably nothing was marked */
        return;
    }
    if (job.state == STORE_RUNNING && active_jobs_find(s->jobs, job.id) == NULL) {
        start(s, &job);
        job_message_publish(s, &job);
    }
}

/* ---- orphaned jobs ---- */

static int release(service *s, int64_t id, shear_error *err) {
    enum store_state state = STORE_QUEUED;
    TRY(group_begin(&s->group, err));
    TRY(store_release(s->store, id, clock_wall_ms(), &state, err));
    log_notice("job %" PRId64 " is queued again", id);
    job_outcome_settle(s, id);
    return SHEAR_OK;
}

/* After a failure of the store: put jobs back into the queue that are running in the store, but on
 * which nothing works, because their outcome was lost. */
static int release_orphans(service *s) {
    const store_job_filter running = {.states = 1u << STORE_RUNNING};
    CLEANUP(store_job_page_deinit) store_job_page page = {0};
    shear_error err = {0};
    TRY(store_jobs(s->store, &running, STORE_PAGE_MAX, &page, &err));
    for (size_t i = 0; i < page.n; i++) {
        if (active_jobs_find(s->jobs, page.jobs[i].id) == NULL)
            TRY(release(s, page.jobs[i].id, &err));
    }
    return SHEAR_OK;
}

/* ---- the queue ---- */

/* Check before the group is opened, so that an idle service does not commit. */
static bool has_next(service *s) {
    store_counts counts;
    shear_error ignored;
    int64_t due = 0;
    if (store_count(s->store, &counts, &ignored) != SHEAR_OK)
        return false;
    return counts.jobs[STORE_QUEUED] > 0 ||
           (store_next_due(s->store, &due, &ignored) == SHEAR_OK && due <= clock_wall_ms());
}

/* Mark the next job. False: there is none, or the store failed. */
static bool mark_next(service *s) {
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    if (group_begin(&s->group, &ignored) != SHEAR_OK ||
        store_next(s->store, clock_wall_ms(), &job, &ignored) != SHEAR_OK || job.id == 0) {
        return false;
    }
    if (group_then(&s->group, start_marked, job.id, sizeof(post_commit)) == NULL) {
        s->jobs->may_have_orphans = true;
        return false;
    }
    s->jobs->marked++;
    return true;
}

void job_queue_fill(service *s) {
    const active_jobs *jobs = s->jobs;
    clock_watch_look(&s->clock);
    if (s->group.failing)
        return;
    if (jobs->may_have_orphans && jobs->marked == 0)
        s->jobs->may_have_orphans = release_orphans(s) != SHEAR_OK;
    while (s->life.state != SHEARD_SERVER_STOPPING &&
           jobs->n + jobs->marked < (size_t)s->config.daemon.max_active_jobs && has_next(s) &&
           mark_next(s)) {
    }
}

void job_queue_stop_all(service *s) {
    for (const active_job *j = s->jobs->first; j != NULL; j = j->next)
        engine_stop_job(s->engine, j->id);
}

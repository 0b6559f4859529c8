/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/engine_events.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_outcome.h"
#include "sheard/account.h"
#include "sheard/advice.h"

#include <inttypes.h>
#include <string.h>

CLEANUP_DEFINE(shear_symmetry, shear_symmetry_free)

/* ---- OPENED: the file's name, content and size are known ---- */

/* Publish the field's name, which is on disk, unless the job has ended meanwhile: its end publishes
 * the name, too. */
static void tell_name(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    (void)err;
    if (code != SHEAR_OK || store_job_get(s->store, post->job, &job, &ignored) != SHEAR_OK ||
        job.state != STORE_RUNNING) {
        return;
    }
    job_message_publish(s, &job);
}

/* Take the field's name from the file, if the job was submitted without one. */
static int name_field(active_job *j, const engine_event *e, shear_error *err) {
    TRY(shear_field_need_name(&e->info, j->path, err));
    j->field = strdup(e->info.name);
    return j->field != NULL ? SHEAR_OK : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
}

/* Return the terms that belong to the job's checkpoint, or NULL: the estimator needs none, or they
 * cannot be read; in that case the job begins again. */
static shear_symmetry *checkpoint_terms(service *s, const active_job *j) {
    CLEANUP(shear_symmetry_release) shear_symmetry *terms = NULL;
    shear_error err = {0};
    if (!shear_estimator_is_symmetric(j->settings.estimator))
        return NULL;
    if (shear_symmetry_new(&terms, &err) != SHEAR_OK ||
        store_checkpoint_load_terms(s->store, j->id, terms, &err) != SHEAR_OK) {
        log_warning("job %" PRId64 " begins again: %s", j->id, err.message);
        return NULL;
    }
    return CLEANUP_TAKE(terms);
}

/* Start measuring, from the job's checkpoint if there is one. */
static void measure(service *s, const active_job *j) {
    engine_checkpoint checkpoint = {0};
    CLEANUP(release_free) char *sums = NULL;
    shear_error ignored;
    if (store_checkpoint_load(s->store, j->id, &checkpoint.next_block, &sums, &ignored) !=
        SHEAR_OK) {
        engine_go(s->engine, j->id, NULL);
        return;
    }
    CLEANUP(shear_symmetry_release) shear_symmetry *terms = checkpoint_terms(s, j);
    checkpoint.sums = sums;
    checkpoint.terms = terms;
    engine_go(s->engine, j->id, &checkpoint);
}

/* End a job whose file is a duplicate of one that was counted before. */
static void end_as_duplicate(service *s, active_job *j) {
    const store_work work = {.now_ms = clock_wall_ms()};
    store_finished end;
    shear_error ignored;
    if (store_finish(s->store, j->id, &work, &end, &ignored) == SHEAR_OK) {
        j->ended = true;
        job_outcome_settle(s, j->id);
    }
    engine_stop_job(s->engine, j->id);
}

static int set_input(service *s, const active_job *j, int64_t *duplicate_of, shear_error *err) {
    const store_input input = {
        .field = j->field, .content = j->checksum, .n_stamps = j->info.n_stamps};
    TRY(group_begin(&s->group, err));
    return store_set_input(s->store, j->id, &input, duplicate_of, err);
}

static void opened(service *s, active_job *j, const engine_event *e) {
    shear_error err = {0};
    int64_t duplicate_of = 0;
    const bool named_by_file = j->field == NULL;
    memcpy(j->checksum, e->checksum, sizeof j->checksum);
    j->info = e->info;
    j->plan = e->plan;
    if (named_by_file && name_field(j, e, &err) != SHEAR_OK) {
        job_outcome_fail(s, j->id, j->failures, job_outcome_reason(&err), &err);
        j->ended = true;
        engine_stop_job(s->engine, j->id);
        return;
    }
    if (set_input(s, j, &duplicate_of, &err) != SHEAR_OK) {
        log_error("job %" PRId64 ": %s", j->id, err.message);
        engine_stop_job(s->engine, j->id);
        return;
    }
    if (duplicate_of != 0) {
        end_as_duplicate(s, j);
        return;
    }
    if (named_by_file)
        group_then(&s->group, tell_name, j->id, sizeof(post_commit));
    j->failed_commits = s->group.failed_commits;
    measure(s, j);
}

/* ---- the others ---- */

static void checkpoint(service *s, const active_job *j, const engine_event *e) {
    const store_progress progress = {.from_block = e->from_block,
                                     .next_block = e->next_block,
                                     .sums = e->sums,
                                     .terms = e->terms,
                                     .terms_size = e->terms_size};
    shear_error err = {0};
    if (group_begin(&s->group, &err) == SHEAR_OK &&
        store_checkpoint(s->store, j->id, &progress, &err) != SHEAR_OK) {
        log_warning("job %" PRId64 ": no checkpoint: %s", j->id, err.message);
    }
}

static int finish(service *s, const active_job *j, const store_work *work, shear_error *err) {
    store_finished end;
    int64_t ignored = 0;
    TRY(group_begin(&s->group, err));
    /* The group that stored the job's input may be the one whose commit failed: store it again. */
    if (j->failed_commits != s->group.failed_commits)
        TRY(set_input(s, j, &ignored, err));
    return store_finish(s->store, j->id, work, &end, err);
}

/* Make the account of the job's file, stored with the contribution. NULL: out of memory, or longer
 * than STORE_ACCOUNT_MAX; the field's report then knows less of this file. */
static char *account_text(const sheard_report_file *file) {
    char *text = NULL;
    shear_error ignored;
    if (sheard_account_format(&text, file, &ignored) == SHEAR_OK &&
        strlen(text) > STORE_ACCOUNT_MAX) {
        free(text);
        text = NULL;
    }
    return text;
}

/* Make the report of the job's file alone. NULL: out of memory. */
static char *result_text(const active_job *j, const engine_event *e,
                         const sheard_report_file *file) {
    char *text = NULL;
    shear_error ignored;
    sheard_advice_list advice;
    sheard_advice_all(&advice, &e->result, &j->plan, NULL);
    const sheard_report report = {.field = j->field,
                                  .result = &e->result,
                                  .settings = &j->settings,
                                  .plan = &j->plan,
                                  .files = file,
                                  .n_files = 1,
                                  .top_file = e->result.top_stamp >= 0 ? file->path : NULL,
                                  .has_truth = j->info.has_truth,
                                  .true_g1 = j->info.sim_g1,
                                  .true_g2 = j->info.sim_g2,
                                  .warnings = advice.lines,
                                  .n_warnings = advice.n,
                                  .seconds = e->seconds};
    sheard_report_json(&text, &report, &ignored);
    return text;
}

static void done(service *s, const active_job *j, const engine_event *e) {
    const sheard_report_file file = {.path = j->path,
                                     .checksum = j->checksum,
                                     .field = j->info.name,
                                     .n_stamps = e->result.n_stamps,
                                     .n_used = e->result.n_used,
                                     .plan = &j->plan,
                                     .seconds = e->seconds};
    CLEANUP(release_free) char *result = result_text(j, e, &file);
    CLEANUP(release_free) char *account = account_text(&file);
    CLEANUP(release_free) char *catalog = catalog_path(s, j->id);
    shear_error err = {0};
    const store_work work = {.sums = e->sums,
                             .result = result,
                             .catalog = catalog,
                             .elapsed_us = (int64_t)(1e6 * e->seconds),
                             .now_ms = clock_wall_ms(),
                             .account = account,
                             .has_truth = j->info.has_truth,
                             .true_g1 = j->info.sim_g1,
                             .true_g2 = j->info.sim_g2,
                             .terms = e->terms,
                             .terms_size = e->terms_size};
    const int code = finish(s, j, &work, &err);
    if (code != SHEAR_OK) {
        const failure_reason reason = {store_is_transient(code) ? STORE_TRANSIENT : STORE_BUG,
                                       store_code_name(code)};
        job_outcome_fail(s, j->id, j->failures, reason, &err);
        return;
    }
    job_outcome_settle(s, j->id);
}

static void stopped(service *s, const active_job *j) {
    shear_error ignored;
    enum store_state state = STORE_QUEUED;
    if (group_begin(&s->group, &ignored) != SHEAR_OK ||
        store_release(s->store, j->id, clock_wall_ms(), &state, &ignored) != SHEAR_OK) {
        s->jobs->may_have_orphans = true;
        return;
    }
    job_outcome_settle(s, j->id);
}

static void process(service *s, const engine_event *e) {
    active_job *j = active_jobs_find(s->jobs, e->job);
    if (j == NULL) {
        s->hooks->other_event(s, e);
        return;
    }
    switch (e->kind) {
    case ENGINE_OPENED:
        opened(s, j, e);
        return;
    case ENGINE_RESUMED:
        log_info("job %" PRId64 " goes on at block %" PRId64, j->id, e->next_block);
        return;
    case ENGINE_CHECKPOINT:
        checkpoint(s, j, e);
        return;
    case ENGINE_DONE:
        done(s, j, e);
        break;
    case ENGINE_FAILED:
        job_outcome_fail(s, j->id, j->failures, job_outcome_reason(&e->error), &e->error);
        break;
    default:
        if (!j->ended)
            stopped(s, j);
        break;
    }
    active_jobs_remove(s->jobs, j);
}

void engine_events_process(service *s) {
    engine_event e;
    while (engine_next_event(s->engine, &e)) {
        process(s, &e);
        engine_event_deinit(&e);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the engine's events into the store. */
#include "service/inner.h"

#include "sheard/account.h"
#include "sheard/advice.h"

#include <stdlib.h>
#include <string.h>

/* The name of its field is on disk. If the job has ended meanwhile, its end tells the name. */
static void tell_name(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error ignored;
    (void)err;
    if (code == SHEAR_OK && store_job_get(s->store, a->job, &job, &ignored) == SHEAR_OK &&
        job.state == STORE_RUNNING) {
        publish_job(s, &job);
    }
    store_job_deinit(&job);
}

/* The terms that belong to the job's checkpoint; NULL: none are wanted, or they cannot be read:
 * then it begins anew. */
static shear_symmetry *checkpoint_terms(service *s, const active_job *j) {
    shear_symmetry *terms = NULL;
    shear_error err = {0};
    if (!shear_estimator_is_symmetric(j->settings.estimator)) {
        return NULL;
    }
    int code = shear_symmetry_new(&terms, &err);
    if (code == SHEAR_OK) {
        code = store_checkpoint_load_terms(s->store, j->id, terms, &err);
    }
    if (code != SHEAR_OK) {
        log_warning("job %lld begins anew: %s", (long long)j->id, err.message);
        shear_symmetry_free(terms);
        return NULL;
    }
    return terms;
}

/* The opened file is known: its name, content and size. A copy of what was counted before ends
 * here. */
static void opened(service *s, active_job *j, const engine_event *e) {
    shear_error err = {0};
    int64_t duplicate_of = 0;
    snprintf(j->checksum, sizeof j->checksum, "%s", e->checksum);
    j->info = e->info;
    j->plan = e->plan;
    const store_input learned = {.field = j->field == NULL ? e->info.name : NULL,
                                 .content = e->checksum,
                                 .n_stamps = e->info.n_stamps};
    const bool named = j->field == NULL;
    if (named && shear_field_need_name(&e->info, j->path, &err) != SHEAR_OK) {
        ending_fail(s, j->id, j->failures, ending_reason_of(&err), &err);
        j->ended = true;
        engine_stop_job(s->engine, j->id);
        return;
    }
    if (named) {
        j->field = strdup(e->info.name);
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_set_input(s->store, j->id, &learned, &duplicate_of, &err);
    }
    if (code != SHEAR_OK) {
        log_error("job %lld: %s", (long long)j->id, err.message);
        engine_stop_job(s->engine, j->id);
        return;
    }
    if (duplicate_of != 0) {
        const store_work work = {.now_ms = wall_ms()};
        store_finished end;
        if (store_finish(s->store, j->id, &work, &end, &err) == SHEAR_OK) {
            j->ended = true;
            ending_settle(s, j->id);
        }
        engine_stop_job(s->engine, j->id);
        return;
    }
    if (named) {
        after *a = group_after(s, tell_name);
        if (a != NULL) {
            a->job = j->id;
        }
    }
    j->failed_commits = s->failed_commits;
    engine_checkpoint checkpoint = {0};
    char *sums = NULL;
    const bool resumed =
        store_checkpoint_load(s->store, j->id, &checkpoint.next_block, &sums, &err) == SHEAR_OK;
    checkpoint.sums = sums;
    shear_symmetry *terms = resumed ? checkpoint_terms(s, j) : NULL;
    checkpoint.terms = terms;
    engine_go(s->engine, j->id, resumed ? &checkpoint : NULL);
    shear_symmetry_free(terms);
    free(sums);
}

/* A commit failed since the job was opened, and with it, it may be, what the store learned then. */
static int learn_again(service *s, const active_job *j, shear_error *err) {
    int64_t duplicate_of = 0;
    const store_input learned = {
        .field = j->field, .content = j->checksum, .n_stamps = j->info.n_stamps};
    return store_set_input(s->store, j->id, &learned, &duplicate_of, err);
}

static sheard_report_file report_file(const active_job *j, const engine_event *e) {
    return (sheard_report_file){.path = j->path,
                                .checksum = j->checksum,
                                .field = j->info.name,
                                .n_stamps = e->result.n_stamps,
                                .n_used = e->result.n_used,
                                .plan = &j->plan,
                                .seconds = e->seconds};
}

/* NULL where there is no memory for it, or it would be too long: then the field's report knows less
 * of this file. */
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

static char *result_text(const active_job *j, const engine_event *e, const sheard_report_file *file,
                         shear_error *err) {
    char *text = NULL;
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
    sheard_report_json(&text, &report, err);
    return text;
}

static void done(service *s, active_job *j, const engine_event *e) {
    shear_error err = {0};
    store_finished end;
    const sheard_report_file file = report_file(j, e);
    char *result = result_text(j, e, &file, &err);
    char *account = account_text(&file);
    char *catalog = catalog_path(s, j->id);
    const store_work work = {.sums = e->sums,
                             .result = result,
                             .catalog = catalog,
                             .elapsed_us = (int64_t)(1e6 * e->seconds),
                             .now_ms = wall_ms(),
                             .account = account,
                             .has_truth = j->info.has_truth,
                             .true_g1 = j->info.sim_g1,
                             .true_g2 = j->info.sim_g2,
                             .terms = e->terms,
                             .terms_size = e->terms_size};
    int code = group_begin(s, &err);
    if (code == SHEAR_OK && j->failed_commits != s->failed_commits) {
        code = learn_again(s, j, &err);
    }
    if (code == SHEAR_OK) {
        code = store_finish(s->store, j->id, &work, &end, &err);
    }
    if (code == SHEAR_OK) {
        ending_settle(s, j->id);
    } else {
        const ending_reason reason = {store_is_transient(code) ? STORE_TRANSIENT : STORE_BUG,
                                      store_code_name(code)};
        ending_fail(s, j->id, j->failures, reason, &err);
    }
    free(result);
    free(account);
    free(catalog);
}

static void stopped(service *s, active_job *j) {
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_release(s->store, j->id, wall_ms(), &state, &err);
    }
    if (code == SHEAR_OK) {
        ending_settle(s, j->id);
    } else {
        s->strays = true;
    }
}

static int save(service *s, const active_job *j, const engine_event *e, shear_error *err) {
    const store_progress progress = {.from_block = e->from_block,
                                     .next_block = e->next_block,
                                     .sums = e->sums,
                                     .terms = e->terms,
                                     .terms_size = e->terms_size};
    return store_checkpoint_terms(s->store, j->id, &progress, err);
}

static void take_event(service *s, engine_event *e) {
    active_job *j = jobs_find(s, e->job);
    shear_error err = {0};
    if (e->job == PROBE_JOB) {
        probe_event(s, e);
        return;
    }
    if (j == NULL) {
        return;
    }
    switch (e->kind) {
    case ENGINE_OPENED:
        opened(s, j, e);
        return;
    case ENGINE_RESUMED:
        log_info("job %lld goes on at block %lld", (long long)j->id, (long long)e->next_block);
        return;
    case ENGINE_CHECKPOINT:
        if (group_begin(s, &err) == SHEAR_OK && save(s, j, e, &err) != SHEAR_OK) {
            log_warning("job %lld: no checkpoint: %s", (long long)j->id, err.message);
        }
        return;
    case ENGINE_DONE:
        done(s, j, e);
        break;
    case ENGINE_FAILED: {
        ending_fail(s, j->id, j->failures, ending_reason_of(&e->error), &e->error);
        break;
    }
    default:
        if (!j->ended) {
            stopped(s, j);
        }
        break;
    }
    jobs_forget(s, j);
}

void events_take(service *s) {
    engine_event e;
    while (engine_next_event(s->engine, &e)) {
        take_event(s, &e);
        engine_event_deinit(&e);
    }
}

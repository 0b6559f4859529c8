/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the queue into the engine, and from the engine's events back into the store. */
#include "service/inner.h"
#include "service/source.h"

#include "sheard/report.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

static void forget(service *s, active_job *j) {
    active_job **at = &s->active;
    while (*at != j) {
        at = &(*at)->next;
    }
    *at = j->next;
    s->n_active--;
    active_free(j);
}

/* ---- the end of an attempt ---- */

void jobs_final(service *s, const store_job *job) {
    catalogue_forget(s, job->id);
    const char *name = spooled_name(s, job->key);
    if (name != NULL) {
        spooled_end(s, name, job);
    }
    waits_job_ended(s, job->id);
    server_end_job(s->server, job->id);
}

/* The store has the job's new state: tell those who wait, and let its file follow. */
static void settled(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error ignored;
    if (code != SHEAR_OK) {
        log_error("job %lld: its end is not on disk (%s); it will run again", (long long)a->job,
                  err->message);
        s->strays = true;
        return;
    }
    if (store_job_get(s->store, a->job, &job, &ignored) != SHEAR_OK) {
        return;
    }
    publish_job(s, &job);
    if (shear_job_state_is_final(job.state)) {
        s->jobs_ended++;
        jobs_final(s, &job);
        if (job.outcome == STORE_COUNTED) {
            news_field_changed(s, job.field, job.settings_digest);
        }
        log_info("job %lld (%s): %s%s%s", (long long)job.id,
                 job.field != NULL ? job.field : "field unknown", store_state_name(job.state),
                 job.state == STORE_FAILED ? ": " : "",
                 job.state == STORE_FAILED && job.message != NULL ? job.message : "");
    }
    store_job_deinit(&job);
}

static void settle_later(service *s, int64_t id) {
    after *a = group_after(s, settled);
    if (a != NULL) {
        a->job = id;
    }
}

/* ---- failures ---- */

typedef struct failure {
    int class;
    const char *name;
} failure;

static failure classify(const shear_error *error) {
    switch (error->code) {
    case READER_E_DIED:
    case READER_E_PROTOCOL:
        return (failure){STORE_BUG, shear_rpc_code_get(SHEAR_RPC_READER_CRASHED)->name};
    case ENGINE_E_CHANGED:
        return (failure){STORE_TRANSIENT, shear_rpc_code_get(SHEAR_RPC_FILE_CHANGED)->name};
    case READER_E_HUNG:
        return (failure){STORE_BUG, shear_rpc_code_get(SHEAR_RPC_READER_TIMEOUT)->name};
    case SHEAR_E_NOMEM:
    case SHEAR_E_IO:
    case SHEAR_E_FULL:
        return (failure){STORE_TRANSIENT, shear_code_name(error->code)};
    case SHEAR_E_INTERNAL:
        return (failure){STORE_BUG, shear_code_name(error->code)};
    default:
        return (failure){STORE_DATA, shear_code_name(error->code)};
    }
}

/* When to try again: a transient failure with doubling back-off and a limit, a bug once, bad data
 * never. */
static int64_t retry_at(const service *s, int class, int64_t failures, int64_t now) {
    if (class == STORE_DATA || (class == STORE_BUG && failures >= 1) ||
        (class == STORE_TRANSIENT && failures + 1 >= s->config.retry.attempts)) {
        return STORE_NEVER;
    }
    int64_t delay = s->config.retry.first_delay_ms;
    for (int64_t i = 0; i < failures && delay < s->config.retry.max_delay_ms; i++) {
        delay *= 2;
    }
    return now + (delay < s->config.retry.max_delay_ms ? delay : s->config.retry.max_delay_ms);
}

static void fail_job(service *s, int64_t id, int64_t failures, int class, const char *name,
                     const shear_error *error) {
    const int64_t now = wall_ms();
    shear_error err = {0};
    int state = 0;
    const store_failure f = {.failure_class = class,
                             .code = name,
                             .message = error->message[0] != '\0' ? error->message : name,
                             .advice = error->advice[0] != '\0' ? error->advice : NULL,
                             .retry_at_ms = retry_at(s, class, failures, now),
                             .now_ms = now};
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_fail(s->store, id, &f, &state, &err);
    }
    if (code == SHEAR_OK) {
        settle_later(s, id);
    } else {
        log_error("job %lld: its failure cannot be stored: %s", (long long)id, err.message);
        s->strays = true;
    }
}

/* ---- starting ---- */

static void start(service *s, const store_job *job) {
    active_job *j = calloc(1, sizeof *j);
    shear_error err = {0};
    source_opened o = {.files = {.fds = {-1, -1, -1, -1}}};
    int class = STORE_TRANSIENT;
    const char *name = shear_code_name(SHEAR_E_NOMEM);
    int code = j != NULL ? SHEAR_OK : shear_fail(&err, SHEAR_E_NOMEM, NULL, "out of memory");
    if (code == SHEAR_OK) {
        *j = (active_job){.id = job->id,
                          .origin = job->origin,
                          .failures = job->failures,
                          .started_ms = wall_ms(),
                          .field = job->field != NULL ? strdup(job->field) : NULL,
                          .digest = strdup(job->settings_digest)};
        shear_settings_init(&j->settings);
        code = shear_settings_apply(&j->settings, job->settings, &err);
        class = STORE_BUG;
    }
    if (code == SHEAR_OK) {
        code = source_open_for_job(s, job, &o, &err);
        class = o.job_class;
        name = o.name;
    }
    if (code == SHEAR_OK) {
        char text[SHEAR_INPUT_TEXT_SIZE];
        j->path = strdup(shear_input_text(&o.input, text, sizeof text));
        j->active_name = o.active_name;
        o.active_name = NULL;
    }
    char *catalogue = code == SHEAR_OK ? catalogue_path(s, job->id) : NULL;
    if (code == SHEAR_OK) {
        const engine_job spec = {.id = job->id,
                                 .priority = job->priority,
                                 .input = &o.input,
                                 .fds = o.files.fds,
                                 .settings = j->settings,
                                 .catalogue = catalogue};
        code = engine_add(s->engine, &spec, &err);
        class = STORE_TRANSIENT;
        for (int i = 0; i < SHEAR_N_PARTS; i++) {
            o.files.fds[i] = -1; /* the engine's, in any case */
        }
    }
    free(catalogue);
    source_opened_deinit(&o);
    if (code != SHEAR_OK) {
        active_free(j);
        fail_job(s, job->id, job->failures, class, name, &err);
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
    int state = 0;
    int code = store_jobs(s->store, &running, STORE_PAGE_MAX, &page, &err);
    for (size_t i = 0; i < page.n && code == SHEAR_OK; i++) {
        const int64_t id = page.jobs[i].id;
        if (jobs_find(s, id) == NULL) {
            code = group_begin(s, &err);
            code = code == SHEAR_OK ? store_release(s->store, id, wall_ms(), &state, &err) : code;
        }
        if (jobs_find(s, id) == NULL && code == SHEAR_OK) {
            log_notice("job %lld is queued again", (long long)id);
            settle_later(s, id);
        }
    }
    s->strays = code != SHEAR_OK;
    store_job_page_deinit(&page);
}

void jobs_fill(service *s) {
    shear_error err = {0};
    if (s->strays && s->store_trouble_ms == 0 && marked(s) == 0) {
        put_back_strays(s);
    }
    while (s->state != SHEAR_SERVER_STOPPING && s->store_trouble_ms == 0 &&
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

/* ---- events ---- */

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

/* The opened file is known: its name, content and size. A copy of what was counted before ends
 * here. */
static void opened(service *s, active_job *j, const engine_event *e) {
    shear_error err = {0};
    int64_t duplicate_of = 0;
    snprintf(j->checksum, sizeof j->checksum, "%s", e->checksum);
    j->info = e->info;
    j->plan = e->plan;
    const store_learned learned = {.field = j->field == NULL ? e->info.name : NULL,
                                   .content = e->checksum,
                                   .n_stamps = e->info.n_stamps};
    const bool named = j->field == NULL;
    if (named) {
        j->field = strdup(e->info.name);
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_learn(s->store, j->id, &learned, &duplicate_of, &err);
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
            settle_later(s, j->id);
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
    engine_go(s->engine, j->id, resumed ? &checkpoint : NULL);
    free(sums);
}

/* A commit failed since the job was opened, and with it, it may be, what the store learned then. */
static int learn_again(service *s, const active_job *j, shear_error *err) {
    int64_t duplicate_of = 0;
    const store_learned learned = {
        .field = j->field, .content = j->checksum, .n_stamps = j->info.n_stamps};
    return store_learn(s->store, j->id, &learned, &duplicate_of, err);
}

static char *result_text(const active_job *j, const engine_event *e, shear_error *err) {
    char *text = NULL;
    const shear_report_file file = {.path = j->path,
                                    .checksum = j->checksum,
                                    .field = j->info.name,
                                    .n_stamps = e->result.n_stamps,
                                    .n_used = e->result.n_used,
                                    .plan = &j->plan,
                                    .seconds = e->seconds};
    const shear_report report = {.field = j->field,
                                 .result = &e->result,
                                 .settings = &j->settings,
                                 .plan = &j->plan,
                                 .files = &file,
                                 .n_files = 1,
                                 .has_truth = j->info.has_truth,
                                 .true_g1 = j->info.sim_g1,
                                 .true_g2 = j->info.sim_g2,
                                 .seconds = e->seconds};
    shear_report_json(&text, &report, err);
    return text;
}

static void done(service *s, active_job *j, const engine_event *e) {
    shear_error err = {0};
    store_finished end;
    char *result = result_text(j, e, &err);
    char *catalogue = catalogue_path(s, j->id);
    const store_work work = {.sums = e->sums,
                             .result = result,
                             .catalogue = catalogue,
                             .elapsed_us = (int64_t)(1e6 * e->seconds),
                             .now_ms = wall_ms()};
    int code = group_begin(s, &err);
    if (code == SHEAR_OK && j->failed_commits != s->failed_commits) {
        code = learn_again(s, j, &err);
    }
    if (code == SHEAR_OK) {
        code = store_finish(s->store, j->id, &work, &end, &err);
    }
    if (code == SHEAR_OK) {
        settle_later(s, j->id);
    } else {
        fail_job(s, j->id, j->failures, store_is_transient(code) ? STORE_TRANSIENT : STORE_BUG,
                 store_code_name(code), &err);
    }
    free(result);
    free(catalogue);
}

static void stopped(service *s, active_job *j) {
    shear_error err = {0};
    int state = 0;
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_release(s->store, j->id, wall_ms(), &state, &err);
    }
    if (code == SHEAR_OK) {
        settle_later(s, j->id);
    } else {
        s->strays = true;
    }
}

static void take_event(service *s, engine_event *e) {
    active_job *j = jobs_find(s, e->job);
    shear_error err = {0};
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
        if (group_begin(s, &err) == SHEAR_OK &&
            store_checkpoint(s->store, j->id, e->next_block, e->sums, &err) != SHEAR_OK) {
            log_warning("job %lld: no checkpoint: %s", (long long)j->id, err.message);
        }
        return;
    case ENGINE_DONE:
        done(s, j, e);
        break;
    case ENGINE_FAILED: {
        const failure f = classify(&e->error);
        fail_job(s, j->id, j->failures, f.class, f.name, &e->error);
        break;
    }
    default:
        if (!j->ended) {
            stopped(s, j);
        }
        break;
    }
    forget(s, j);
}

void jobs_take_events(service *s) {
    engine_event e;
    while (engine_next_event(s->engine, &e)) {
        take_event(s, &e);
        engine_event_deinit(&e);
    }
}

void jobs_stop_all(service *s) {
    for (active_job *j = s->active; j != NULL; j = j->next) {
        engine_stop_job(s->engine, j->id);
    }
}

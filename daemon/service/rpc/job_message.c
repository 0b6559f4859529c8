/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records of the store as messages. */
#include "service/inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int phase_of(const engine_progress *at) {
    switch (at->stage) {
    case ENGINE_OPENING:
        return SHEARD_PHASE_OPENING;
    case ENGINE_HASHING:
        return SHEARD_PHASE_HASHING;
    case ENGINE_WAITING_MEMORY:
        return SHEARD_PHASE_WAITING_MEMORY;
    case ENGINE_PREPARING:
        return SHEARD_PHASE_PREPARING;
    case ENGINE_MEASURING:
        return SHEARD_PHASE_MEASURING;
    default:
        return SHEARD_PHASE_FINISHING;
    }
}

bool present_running(service *s, int64_t id, sheard_msg_progress *p) {
    engine_progress at;
    const active_job *j = jobs_find(s, id);
    if (j == NULL || !engine_get_progress(s->engine, id, &at)) {
        return false;
    }
    p->phase = phase_of(&at);
    if (at.stage == ENGINE_HASHING) {
        p->bytes_done = at.hashed;
        p->bytes_total = at.bytes;
    }
    if (at.total >= 0) {
        const double seconds = 1e-3 * (double)(steady_ms() - j->started_ms);
        p->done = at.done;
        p->total = at.total;
        p->rate = seconds > 0.0 ? (double)p->done / seconds : NAN;
        p->eta_s = p->rate > 0.0 ? (double)(p->total - p->done) / p->rate : NAN;
    }
    return true;
}

static void present_progress(service *s, const store_job *job, sheard_msg_progress *p) {
    *p = (sheard_msg_progress){
        .total = job->n_stamps, .rate = NAN, .eta_s = NAN, .bytes_done = -1, .bytes_total = -1};
    if (job->state == STORE_DONE) {
        p->done = job->n_stamps;
        p->rate = job->elapsed_us > 0 ? 1e6 * (double)job->n_stamps / (double)job->elapsed_us : NAN;
    } else if (job->state == STORE_RUNNING) {
        present_running(s, job->id, p);
    }
}

void present_job(service *s, const store_job *job, sheard_msg_job *out) {
    sheard_rpc_error ignored;
    const char *user = user_name(s, job->owner);
    /* The numbers of the enums of the store and the protocol are the same. */
    *out = (sheard_msg_job){.id = job->id,
                            .state = (enum sheard_job_state)job->state,
                            .job_class = (enum sheard_job_class)job->failure_class,
                            .code = job->code,
                            .message = job->message,
                            .advice = job->advice,
                            .field = job->field,
                            .owner = job->owner,
                            .user = user != NULL ? strdup(user) : NULL,
                            .origin = (enum sheard_job_origin)job->origin,
                            .priority = job->priority,
                            .force = job->force,
                            .key = job->key,
                            .cancel_asked = job->cancel_asked,
                            .created_ms = job->created_ms,
                            .started_ms = job->started_ms,
                            .finished_ms = job->finished_ms,
                            .not_before_ms = job->not_before_ms,
                            .attempts = job->attempts,
                            .outcome = (enum sheard_job_outcome)job->outcome,
                            .duplicate_of = job->duplicate_of,
                            .settings = job->settings,
                            .digest = job->settings_digest,
                            .checksum = job->content,
                            .result = job->result,
                            .catalog = job->state != STORE_RETRACTED ? job->catalog : NULL,
                            .dropped_name = job->dropped,
                            .file_now = spooled_where(s, job)};
    if (sheard_source_parse(&out->source, job->source, &ignored) != SHEARD_RPC_OK) {
        out->source = (sheard_msg_source){0};
    }
    present_progress(s, job, &out->progress);
}

void present_job_free(sheard_msg_job *out) {
    sheard_source_deinit(&out->source);
    free((char *)out->user);
    free((char *)out->file_now);
    *out = (sheard_msg_job){0};
}

void publish_job(service *s, const store_job *job) {
    if (server_is_watched(s->server, SHEARD_NOTICE_JOB_CHANGED, job->id, job->field)) {
        sheard_notice_params params = {0};
        present_job(s, job, &params.job_changed.job);
        params.job_changed.job.result = NULL;
        server_publish(s->server, SHEARD_NOTICE_JOB_CHANGED, job->id, job->field, &params);
        present_job_free(&params.job_changed.job);
    }
}

/* The counted sums, and those of the jobs that run now (`partial`), joined: exact, so that the
 * result does not depend on the order. */
static int sums_now(service *s, const store_field *f, bool partial, shear_field_sums **sums,
                    int64_t *running, size_t room, size_t *n, shear_error *err) {
    int code = f->sums != NULL && f->sums[0] != '\0' ? shear_field_sums_parse(sums, f->sums, err)
                                                     : shear_field_sums_new(sums, err);
    *n = 0;
    for (const active_job *j = s->active; code == SHEAR_OK && j != NULL; j = j->next) {
        const bool same = j->field != NULL && strcmp(j->field, f->name) == 0 &&
                          strcmp(j->digest, f->settings_digest) == 0;
        if (same && !j->ended && *n < room) {
            running[(*n)++] = j->id;
            if (partial) {
                engine_partial(s->engine, j->id, *sums);
            }
        }
    }
    return code;
}

static bool has_row(const store_field_page *page, const char *digest) {
    for (size_t i = 0; i < page->n; i++) {
        if (strcmp(page->fields[i].settings_digest, digest) == 0) {
            return true;
        }
    }
    return false;
}

static int add_row(store_field_page *page, const char *name, const active_job *j,
                   shear_error *err) {
    char settings[SHEARD_MSG_SETTINGS_SIZE];
    const int code = sheard_settings_write(&j->settings, settings, sizeof settings, err);
    store_field *grown =
        code == SHEAR_OK ? realloc(page->fields, (page->n + 1) * sizeof *grown) : NULL;
    if (code != SHEAR_OK) {
        return code;
    }
    if (grown != NULL) {
        page->fields = grown;
        store_field *f = &grown[page->n++];
        *f = (store_field){.name = strdup(name),
                           .settings_digest = strdup(j->digest),
                           .settings = strdup(settings),
                           .sums = strdup("")};
        if (f->name != NULL && f->settings_digest != NULL && f->settings != NULL &&
            f->sums != NULL) {
            return SHEAR_OK;
        }
    }
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the rows of a field");
}

int present_begun(service *s, const char *name, store_field_page *page, shear_error *err) {
    const size_t counted = page->n;
    int code = SHEAR_OK;
    for (const active_job *j = s->active; code == SHEAR_OK && j != NULL; j = j->next) {
        if (!j->ended && j->field != NULL && strcmp(j->field, name) == 0 &&
            !has_row(page, j->digest)) {
            code = add_row(page, name, j, err);
        }
    }
    for (size_t i = counted; code == SHEAR_OK && i < page->n; i++) {
        for (const active_job *j = s->active; j != NULL; j = j->next) {
            page->fields[i].unfinished += !j->ended && j->field != NULL &&
                                          strcmp(j->field, name) == 0 &&
                                          strcmp(j->digest, page->fields[i].settings_digest) == 0;
        }
    }
    return code;
}

/* A field's result by its settings' estimator, and how many jobs are counted in it. Of pdf-sym only
 * what was counted is in it: stamps of running jobs would have to be solved anew with every
 * question. */
static int result_of(service *s, const store_field *f, const shear_settings *settings,
                     const shear_field_sums *sums, shear_result *out, int64_t *jobs,
                     shear_error *err) {
    *jobs = f->jobs;
    if (shear_estimator_is_symmetric(settings->estimator)) {
        return solutions_get(s, f, sums, out, jobs, err);
    }
    shear_field_result(sums, out);
    return SHEAR_OK;
}

int present_field(service *s, const store_field *f, const store_contribution_page *counted,
                  sheard_msg_field_row *out, field_reason *why, shear_error *err) {
    shear_field_sums *sums = NULL;
    shear_result result;
    shear_settings settings;
    char *report_text = NULL;
    int64_t jobs = 0;
    int64_t *running = calloc(SHEARD_MSG_LIST_MAX, sizeof *running);
    size_t n = 0;
    if (running == NULL) {
        shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
        return SHEAR_E_NOMEM;
    }
    int code = sheard_settings_read(&settings, f->settings, err);
    if (code == SHEAR_OK) {
        code = sums_now(s, f, !shear_estimator_is_symmetric(settings.estimator), &sums, running,
                        SHEARD_MSG_LIST_MAX, &n, err);
    }
    if (code == SHEAR_OK) {
        code = result_of(s, f, &settings, sums, &result, &jobs, err);
    }
    if (code == SHEAR_OK) {
        code = field_report(s, f, &settings, &result, counted, &report_text, err);
    }
    if (code == SHEAR_OK) {
        reason_begin(f, &result, why);
    }
    shear_field_sums_free(sums);
    if (code != SHEAR_OK) {
        free(running);
        return code;
    }
    *out = (sheard_msg_field_row){.report = report_text,
                                  .digest = f->settings_digest,
                                  .jobs = jobs,
                                  .unfinished = f->unfinished,
                                  .partial = f->unfinished > 0,
                                  .running = running,
                                  .n_running = n,
                                  .files_left_out = f->jobs - (int64_t)counted->n,
                                  .updated_ms = f->updated_ms};
    return SHEAR_OK;
}

void present_field_free(sheard_msg_field_row *out) {
    free((char *)out->report);
    free((int64_t *)out->running);
    *out = (sheard_msg_field_row){0};
}

void present_summary(service *s, const store_field *f, sheard_msg_summary *out) {
    shear_field_sums *sums = NULL;
    shear_settings settings;
    int64_t jobs = f->jobs;
    shear_result r = {.n_stamps = f->n_stamps,
                      .n_used = f->n_used,
                      .g1 = NAN,
                      .g2 = NAN,
                      .g1_err = NAN,
                      .g2_err = NAN};
    if (f->sums != NULL && sheard_settings_read(&settings, f->settings, NULL) == SHEAR_OK &&
        shear_field_sums_parse(&sums, f->sums, NULL) == SHEAR_OK &&
        result_of(s, f, &settings, sums, &r, &jobs, NULL) != SHEAR_OK) {
        r.g1 = r.g2 = r.g1_err = r.g2_err = NAN;
    }
    shear_field_sums_free(sums);
    *out = (sheard_msg_summary){.field = f->name,
                                .digest = f->settings_digest,
                                .g1 = r.g1,
                                .g1_err = r.g1_err,
                                .g2 = r.g2,
                                .g2_err = r.g2_err,
                                .n_stamps = r.n_stamps,
                                .n_used = r.n_used,
                                .jobs = jobs,
                                .unfinished = f->unfinished,
                                .partial = f->unfinished > 0,
                                .updated_ms = f->updated_ms,
                                .reason = reason_brief(f, &r)};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_message.h"

#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/spooled_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const enum sheard_job_phase phases[] = {[ENGINE_OPENING] = SHEARD_PHASE_OPENING,
                                               [ENGINE_HASHING] = SHEARD_PHASE_HASHING,
                                               [ENGINE_WAITING_MEMORY] =
                                                   SHEARD_PHASE_WAITING_MEMORY,
                                               [ENGINE_PREPARING] = SHEARD_PHASE_PREPARING,
                                               [ENGINE_MEASURING] = SHEARD_PHASE_MEASURING,
                                               [ENGINE_FINISHING] = SHEARD_PHASE_FINISHING};

static const sheard_msg_progress no_progress = {
    .total = -1, .rate = NAN, .eta_s = NAN, .bytes_done = -1, .bytes_total = -1};

/* Get the progress of a running job. False, with *p unchanged: the engine does not have it. */
static bool get_running(service *s, const active_job *j, sheard_msg_progress *p) {
    engine_progress at;
    if (j == NULL || !engine_get_progress(s->engine, j->id, &at))
        return false;
    p->phase = phases[at.stage];
    if (at.stage == ENGINE_HASHING) {
        p->bytes_done = at.hashed;
        p->bytes_total = at.bytes;
    }
    if (at.total >= 0) {
        const double seconds = 1e-3 * (double)(clock_steady_ms() - j->started_ms);
        p->done = at.done;
        p->total = at.total;
        p->rate = seconds > 0.0 ? (double)p->done / seconds : NAN;
        p->eta_s = p->rate > 0.0 ? (double)(p->total - p->done) / p->rate : NAN;
    }
    return true;
}

static void get_progress(service *s, const store_job *job, sheard_msg_progress *p) {
    *p = no_progress;
    p->total = job->n_stamps;
    if (job->state == STORE_DONE) {
        p->done = job->n_stamps;
        p->rate = job->elapsed_us > 0 ? 1e6 * (double)job->n_stamps / (double)job->elapsed_us : NAN;
    } else if (job->state == STORE_RUNNING) {
        get_running(s, active_jobs_find(s->jobs, job->id), p);
    }
}

void job_to_message(service *s, const store_job *job, sheard_msg_job *out) {
    sheard_rpc_error ignored;
    const char *user = user_names_get(&s->users, job->owner, (int64_t)uv_now(&s->loop));
    /* The enums of the store and the protocol have the same numbers. */
    *out =
        (sheard_msg_job){.id = job->id,
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
                         .file_now = spooled_file_where(s->spool, s->config.spool.directory, job)};
    (void)sheard_source_parse(&out->source, job->source, &ignored); /* empty on an error */
    get_progress(s, job, &out->progress);
}

void job_message_deinit(sheard_msg_job *out) {
    sheard_source_deinit(&out->source);
    free((char *)out->user);
    free((char *)out->file_now);
    *out = (sheard_msg_job){0};
}

void job_message_publish(service *s, const store_job *job) {
    if (!server_is_watched(s->server, SHEARD_NOTICE_JOB_CHANGED, job->id, job->field))
        return;
    sheard_notice_params params = {0};
    job_to_message(s, job, &params.job_changed.job);
    params.job_changed.job.result = NULL;
    server_publish(s->server, SHEARD_NOTICE_JOB_CHANGED, job->id, job->field, &params);
    job_message_deinit(&params.job_changed.job);
}

void job_message_publish_progress(service *s) {
    for (const active_job *j = s->jobs->first; j != NULL; j = j->next) {
        sheard_notice_params params = {.job_progress = {.id = j->id, .progress = no_progress}};
        if (server_is_watched(s->server, SHEARD_NOTICE_JOB_PROGRESS, j->id, j->field) &&
            get_running(s, j, &params.job_progress.progress)) {
            server_publish(s->server, SHEARD_NOTICE_JOB_PROGRESS, j->id, j->field, &params);
        }
    }
}

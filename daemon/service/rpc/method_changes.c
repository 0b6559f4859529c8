/* SPDX-License-Identifier: GPL-3.0-or-later */
/* submit, cancel, retract, retry: add or change a job, and reply when the change is on disk. */
#include "base/cleanup.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/fields/change_notifier.h"
#include "service/fields/estimates.h"
#include "service/intake/file_disposal.h"
#include "service/intake/submission.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_outcome.h"
#include "service/jobs/job_source.h"
#include "service/jobs/rpc_errors.h"
#include "service/jobs/spooled_file.h"
#include "service/rpc/methods.h"
#include "service/rpc/pending_waits.h"

/* ---- the reply, after the commit ---- */

typedef struct job_reply {
    post_commit post; /* first */
    server_handle to;
    bool submit; /* the method is submit; else one whose reply is the job alone */
    bool known;  /* of submit: the idempotency key had been used before */
    char active_name[SPOOL_NAME_SIZE]; /* of retry: the job's file; "": none */
} job_reply;

/* Reply with an error of the store. */
static void reply_error(service *s, server_handle to, int code, const shear_error *err) {
    sheard_rpc_error error;
    rpc_error_from_store(&error, code, err);
    server_reply_error(s->server, to, &error);
}

/* Register a copy of *reply, and `run`, for after the commit. */
static int reply_later(service *s, post_commit_run *run, int64_t job, const job_reply *reply,
                       sheard_rpc_error *error) {
    job_reply *later = group_then(&s->group, run, job, sizeof *later);
    if (later == NULL) {
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                               "out of memory for a reply; the request may have been carried out");
    }
    const post_commit post = later->post;
    *later = *reply;
    later->post = post;
    return SHEARD_RPC_OK;
}

static void reply_with(service *s, const job_reply *later, const store_job *job) {
    CLEANUP(job_message_deinit) sheard_msg_job message = {0};
    job_to_message(s, job, &message);
    const sheard_reply submitted = {.submit = {.job = message, .known = later->known}};
    const sheard_reply changed = {.cancel = message};
    server_reply(s->server, later->to, later->submit ? &submitted : &changed);
}

/* Reply with the job as it is now, and notify others. */
static void reply_now(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    const job_reply *later = (const job_reply *)post;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error own = {0};
    if (code == SHEAR_OK) {
        code = store_job_get(s->store, post->job, &job, &own);
        err = &own;
    }
    if (code != SHEAR_OK) {
        reply_error(s, later->to, code, err);
        return;
    }
    file_disposal_end(s, &job);
    reply_with(s, later, &job);
    job_message_publish(s, &job);
    if (store_state_is_final(job.state))
        job_outcome_tell(s, &job);
}

/* ---- submit ---- */

/* Begin to wait for the end of the job, which is on disk. */
static void reply_when_ended(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    const job_reply *later = (const job_reply *)post;
    if (code != SHEAR_OK) {
        reply_error(s, later->to, code, err);
    } else {
        pending_waits_add_submitted(s, later->to, later->known, post->job);
    }
}

/* Check that the service takes new jobs: it is not draining or stopping. */
static int check_running(const service *s, sheard_rpc_error *error) {
    if (s->life.state == SHEARD_SERVER_RUNNING)
        return SHEARD_RPC_OK;
    return sheard_rpc_fail(
        error, s->life.state == SHEARD_SERVER_DRAINING ? SHEARD_RPC_DRAINING : SHEARD_RPC_STOPPING,
        NULL, "the service takes no new jobs");
}

int method_submit(service *s, const server_request *r, sheard_rpc_error *error) {
    const sheard_msg_submit *submit = &r->request->params.submit;
    const submission sub = {
        .submit = submit, .peer = *r->peer, .origin = STORE_SOCKET, .key = submit->key};
    int64_t id = 0;
    bool known = false;
    if (!permissions_may_submit(&s->permissions, r->peer)) {
        return sheard_rpc_fail(
            error, SHEARD_RPC_NOT_OWNER, NULL,
            "you are in none of the groups that may submit jobs ([access] submit_groups)");
    }
    TRY(check_running(s, error));
    TRY(submission_store(s, &sub, &id, &known, error));
    const job_reply reply = {.to = r->handle, .submit = true, .known = known};
    return reply_later(s, submit->wait ? reply_when_ended : reply_now, id, &reply, error);
}

/* ---- the others: find the job, and open the group ---- */

/* Get the job that the request names. The peer must own it or be an administrator. */
static int find_job(service *s, const server_request *r, store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    const int code = store_job_get(s->store, r->request->params.id.id, job, &err);
    TRY(rpc_error_from_store(error, code, &err));
    return job->owner == r->peer->uid || permissions_is_admin(&s->permissions, r->peer)
               ? SHEARD_RPC_OK
               : sheard_rpc_fail(error, SHEARD_RPC_NOT_OWNER, NULL,
                                 "the job belongs to somebody else");
}

static int begin(service *s, sheard_rpc_error *error) {
    shear_error err = {0};
    return rpc_error_from_store(error, group_begin(&s->group, &err), &err);
}

/* ---- cancel ---- */

int method_cancel(service *s, const server_request *r, sheard_rpc_error *error) {
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    TRY(find_job(s, r, &job, error));
    TRY(begin(s, error));
    const int code = store_cancel(s->store, job.id, clock_wall_ms(), &state, &err);
    TRY(rpc_error_from_store(error, code, &err));
    if (state == STORE_RUNNING)
        engine_stop_job(s->engine, job.id);
    return reply_later(s, reply_now, job.id, &(job_reply){.to = r->handle}, error);
}

/* ---- retract: take a job's contribution back ---- */

/* Reply, remove the catalogs of retracted jobs, and publish the field's change. */
static void reply_retracted(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    reply_now(post, code, err);
    if (code != SHEAR_OK)
        return;
    catalogs_remove_retracted(s);
    if (store_job_get(s->store, post->job, &job, &ignored) == SHEAR_OK)
        change_notifier_note(s, job.field, job.settings_digest);
}

int method_retract(service *s, const server_request *r, sheard_rpc_error *error) {
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error err = {0};
    TRY(find_job(s, r, &job, error));
    TRY(begin(s, error));
    TRY(rpc_error_from_store(error, store_retract(s->store, job.id, &err), &err));
    estimates_note_retraction(s);
    return reply_later(s, reply_retracted, job.id, &(job_reply){.to = r->handle}, error);
}

/* ---- retry: queue a failed or cancelled job again ---- */

/* Open the job's files, as at its submission, and close them. */
static int try_to_open(const service *s, const store_job *job, sheard_rpc_error *error) {
    CLEANUP(job_source_deinit) job_source o = {.files = SOURCE_FILES_NONE};
    shear_error err = {0};
    const int code = job_source_open(s, job, &o, &err);
    return code == SHEAR_OK ? SHEARD_RPC_OK : rpc_error_as(error, o.rpc, &err);
}

static int queue_again(service *s, const store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    TRY(begin(s, error));
    const int code = store_retry(s->store, job->id, s->config.limits.queue, &err);
    return rpc_error_from_store(error, code, &err);
}

/* Queue the job again in this group, after its dropped file is back in active/. On error the file
 * returns to where it was. */
static int retry(service *s, store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    if (job->state != STORE_FAILED && job->state != STORE_CANCELLED) {
        return queue_again(s, job, error); /* the store refuses it with wrong_state */
    }
    TRY(rpc_error_from_spool(error, spooled_file_restore(s->spool, job, &err), &err));
    int code = try_to_open(s, job, error);
    code = code == SHEARD_RPC_OK ? queue_again(s, job, error) : code;
    if (code != SHEARD_RPC_OK)
        file_disposal_end(s, job);
    return code;
}

/* If the commit failed, have the spool report the file again, so that it is moved to where it
 * belongs. */
static void reply_retried(post_commit *post, int code, const shear_error *err) {
    const service *s = post->context;
    const job_reply *later = (const job_reply *)post;
    shear_error ignored;
    if (code != SHEAR_OK && later->active_name[0] != '\0' && s->spool != NULL)
        spool_refuse(s->spool, later->active_name, &ignored);
    reply_now(post, code, err);
}

int method_retry(service *s, const server_request *r, sheard_rpc_error *error) {
    CLEANUP(store_job_deinit) store_job job = {0};
    job_reply reply = {.to = r->handle};
    TRY(find_job(s, r, &job, error));
    TRY(check_running(s, error));
    TRY(retry(s, &job, error));
    if (!spooled_file_name(&job, reply.active_name))
        reply.active_name[0] = '\0';
    return reply_later(s, reply_retried, job.id, &reply, error);
}

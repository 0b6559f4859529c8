/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cancel, retract, retry: change a job, and reply when the change is on disk. */
#include "base/cleanup.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/fields/change_notifier.h"
#include "service/fields/estimates.h"
#include "service/intake/file_disposal.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/job_source.h"
#include "service/jobs/rpc_errors.h"
#include "service/jobs/spooled_file.h"
#include "service/rpc/job_reply.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"

/* ---- cancel ---- */

void method_cancel(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    if (!job_reply_may_change(s, r, id))
        return;
    int code = group_begin(&s->group, &err);
    code = code == SHEAR_OK ? store_cancel(s->store, id, clock_wall_ms(), &state, &err) : code;
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    if (state == STORE_RUNNING)
        engine_stop_job(s->engine, id);
    job_reply_later(s, job_reply_run, sizeof(job_reply), r->handle, id);
}

/* ---- retract: take a job's contribution back ---- */

/* Reply, remove the catalogs of retracted jobs, and publish the field's change. */
static void reply_retracted(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    job_reply_run(post, code, err);
    if (code != SHEAR_OK)
        return;
    catalogs_remove_retracted(s);
    if (store_job_get(s->store, post->job, &job, &ignored) == SHEAR_OK)
        change_notifier_note(s, job.field, job.settings_digest);
}

void method_retract(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    if (!job_reply_may_change(s, r, id))
        return;
    int code = group_begin(&s->group, &err);
    code = code == SHEAR_OK ? store_retract(s->store, id, &err) : code;
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    estimates_note_retraction(s);
    job_reply_later(s, reply_retracted, sizeof(job_reply), r->handle, id);
}

/* ---- retry: queue a failed or cancelled job again ---- */

/* Move the dropped file of a job that is to be tried again back to active/. */
static int take_back(service *s, const store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    const int code = spooled_file_restore(s->spool, job, &err);
    switch (code) {
    case SHEAR_OK:
        return SHEARD_RPC_OK;
    case SPOOL_GONE:
        return rpc_error_as(error, SHEARD_RPC_NO_SUCH_FILE, &err);
    case SPOOL_REPLACED:
        return rpc_error_as(error, SHEARD_RPC_FILE_CHANGED, &err);
    case SPOOL_NOT_REGULAR:
        return rpc_error_as(error, SHEARD_RPC_NOT_REGULAR, &err);
    default:
        return rpc_error_as(error, SHEARD_RPC_IO, &err);
    }
}

/* Open the job's files, as at its submission, and close them. */
static int try_to_open(const service *s, const store_job *job, sheard_rpc_error *error) {
    CLEANUP(job_source_deinit) job_source o = {.files = SOURCE_FILES_NONE};
    shear_error err = {0};
    const int code = job_source_open(s, job, &o, &err);
    if (code != SHEAR_OK && spooled_file_is_field(job))
        return rpc_error_as(error, sheard_rpc_code_find(o.fail_name), &err);
    return code == SHEAR_OK ? SHEARD_RPC_OK : rpc_error_from_access(error, code, &err);
}

static int queue_again(service *s, const store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    int code = group_begin(&s->group, &err);
    code = code == SHEAR_OK ? store_retry(s->store, job->id, s->config.limits.queue, &err) : code;
    return code == SHEAR_OK ? SHEARD_RPC_OK : rpc_error_from_store(error, code, &err);
}

/* Queue the job again in this group, after its file is back in active/. On error the file returns
 * to where it was. */
static int retry(service *s, store_job *job, sheard_rpc_error *error) {
    if (job->state != STORE_FAILED && job->state != STORE_CANCELLED) {
        return queue_again(s, job, error); /* the store refuses it with wrong_state */
    }
    int code = take_back(s, job, error);
    if (code != SHEARD_RPC_OK)
        return code;
    code = try_to_open(s, job, error);
    code = code == SHEARD_RPC_OK ? queue_again(s, job, error) : code;
    if (code != SHEARD_RPC_OK)
        file_disposal_end(s, job);
    return code;
}

typedef struct retry_reply {
    job_reply reply;                   /* first */
    char active_name[SPOOL_NAME_SIZE]; /* of its file; "": none */
} retry_reply;

/* If the commit failed, have the spool report the file again, so that it is moved to where it
 * belongs. */
static void reply_retried(post_commit *post, int code, const shear_error *err) {
    const service *s = post->context;
    const retry_reply *later = (const retry_reply *)post;
    shear_error ignored;
    if (code != SHEAR_OK && later->active_name[0] != '\0' && s->spool != NULL)
        spool_refuse(s->spool, later->active_name, &ignored);
    job_reply_run(post, code, err);
}

void method_retry(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error err = {0};
    sheard_rpc_error error;
    if (!job_reply_may_change(s, r, id))
        return;
    if (s->life.state != SHEARD_SERVER_RUNNING) {
        refuse_new_jobs(s, r->handle);
        return;
    }
    const int code = store_job_get(s->store, id, &job, &err);
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    if (retry(s, &job, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
        return;
    }
    retry_reply *later = job_reply_later(s, reply_retried, sizeof *later, r->handle, id);
    if (later != NULL && !spooled_file_name(&job, later->active_name))
        later->active_name[0] = '\0';
}

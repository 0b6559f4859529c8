/* SPDX-License-Identifier: GPL-3.0-or-later */
/* submit, cancel, retry: answered when the change is on disk. */
#include "service/jobs/job_source.h"
#include "service/rpc/methods.h"

#include <string.h>

void method_reply_job(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error local = {0};
    if (code != SHEAR_OK) {
        method_refuse_store(s, a->to, code, err);
        return;
    }
    code = store_job_get(s->store, a->job, &job, &local);
    if (code != SHEAR_OK) {
        method_refuse_store(s, a->to, code, &local);
        return;
    }
    spooled_end(s, &job);
    sheard_reply reply = {0};
    sheard_msg_job *message = a->method == SHEARD_METHOD_SUBMIT   ? &reply.submit.job
                              : a->method == SHEARD_METHOD_CANCEL ? &reply.cancel
                              : a->method == SHEARD_METHOD_RETRY  ? &reply.retry
                                                                  : &reply.retract;
    present_job(s, &job, message);
    reply.submit.known = a->method == SHEARD_METHOD_SUBMIT && a->flag;
    server_reply(s->server, a->to, &reply);
    present_job_free(message);
    publish_job(s, &job);
    if (sheard_job_state_is_final(job.state)) {
        ending_tell(s, &job);
    }
    store_job_deinit(&job);
}

/* As method_reply_job, but the reply comes when the job has ended. */
static void reply_when_ended(service *s, after *a, int code, const shear_error *err) {
    if (code != SHEAR_OK) {
        method_refuse_store(s, a->to, code, err);
    } else {
        waits_for_submitted(s, a->to, a->flag, a->job);
    }
}

static after *answer_later(service *s, void (*run)(service *, after *, int, const shear_error *),
                           server_handle to, int method, int64_t job, bool flag) {
    after *a = group_after(s, run);
    if (a == NULL) {
        method_refuse(s, to, SHEARD_RPC_OUT_OF_MEMORY,
                      "out of memory for a reply; the request may have been carried out");
        return NULL;
    }
    a->to = to;
    a->method = method;
    a->job = job;
    a->flag = flag;
    return a;
}

void method_submit(service *s, const server_request *r) {
    const sheard_msg_submit *submit = &r->request->params.submit;
    sheard_rpc_error error;
    int64_t id = 0;
    bool known = false;
    const submission sub = {
        .submit = submit, .peer = *r->peer, .origin = STORE_SOCKET, .key = submit->key};
    if (s->config.access.submit_groups.n > 0 && !access_list_has(s->submitters, &sub.peer) &&
        !peer_is_admin(s, r->peer)) {
        method_refuse(
            s, r->handle, SHEARD_RPC_NOT_OWNER,
            "you are in none of the groups that may submit jobs ([access] submit_groups)");
    } else if (s->state != SHEARD_SERVER_RUNNING) {
        method_refuse_new(s, r->handle);
    } else if (submit_job(s, &sub, &id, &known, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        answer_later(s, submit->wait ? reply_when_ended : method_reply_job, r->handle,
                     SHEARD_METHOD_SUBMIT, id, known);
    }
}

bool method_may_change(service *s, const server_request *r, int64_t id) {
    store_job job = {0};
    shear_error err = {0};
    const int code = store_job_get(s->store, id, &job, &err);
    const bool mine = job.owner == r->peer->uid || peer_is_admin(s, r->peer);
    store_job_deinit(&job);
    if (code != SHEAR_OK) {
        method_refuse_store(s, r->handle, code, &err);
    } else if (!mine) {
        method_refuse(s, r->handle, SHEARD_RPC_NOT_OWNER, "the job belongs to somebody else");
    }
    return code == SHEAR_OK && mine;
}

void method_cancel(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    if (!method_may_change(s, r, id)) {
        return;
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_cancel(s->store, id, wall_ms(), &state, &err);
    }
    if (code != SHEAR_OK) {
        method_refuse_store(s, r->handle, code, &err);
        return;
    }
    if (state == STORE_RUNNING) {
        engine_stop_job(s->engine, id);
    }
    answer_later(s, method_reply_job, r->handle, SHEARD_METHOD_CANCEL, id, false);
}

/* The dropped file of a job that is to be tried again goes back into active/. */
static int take_back(service *s, const store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    const int code = spooled_take_back(s, job, &err);
    const int rpc = code == SPOOL_GONE          ? SHEARD_RPC_NO_SUCH_FILE
                    : code == SPOOL_REPLACED    ? SHEARD_RPC_FILE_CHANGED
                    : code == SPOOL_NOT_REGULAR ? SHEARD_RPC_NOT_REGULAR
                                                : SHEARD_RPC_IO;
    return code == SHEAR_OK ? SHEARD_RPC_OK
                            : sheard_rpc_fail(error, rpc, err.advice[0] != '\0' ? err.advice : NULL,
                                              "%s", err.message);
}

/* Its files are opened, as at its submission, and closed. */
static int try_to_open(service *s, const store_job *job, sheard_rpc_error *error) {
    source_opened o;
    shear_error err = {0};
    const int code = source_open_for_job(s, job, &o, &err);
    const int rpc = sheard_rpc_code_find(o.name);
    source_opened_deinit(&o);
    if (code == SHEAR_OK) {
        return SHEARD_RPC_OK;
    }
    return spooled_is_own(job)
               ? sheard_rpc_fail(error, rpc, err.advice[0] != '\0' ? err.advice : NULL, "%s",
                                 err.message)
               : rpc_from_access(error, code, &err);
}

/* Queued again, in this group; its file is back before. Where that was in vain, the file returns to
 * where it was. */
static int retry(service *s, store_job *job, sheard_rpc_error *error) {
    shear_error err = {0};
    const bool may = job->state == STORE_FAILED || job->state == STORE_CANCELLED;
    int code = may ? take_back(s, job, error) : SHEARD_RPC_OK; /* else wrong_state, below */
    if (code != SHEARD_RPC_OK) {
        return code;
    }
    code = may ? try_to_open(s, job, error) : SHEARD_RPC_OK;
    int stored = code == SHEARD_RPC_OK ? group_begin(s, &err) : SHEAR_OK;
    if (code == SHEARD_RPC_OK && stored == SHEAR_OK) {
        stored = store_retry(s->store, job->id, s->config.limits.queue, &err);
    }
    if (stored != SHEAR_OK) {
        code = rpc_from_store(error, stored, &err);
    }
    if (code != SHEARD_RPC_OK && may) {
        spooled_end(s, job);
    }
    return code;
}

/* Whether the job is queued again is not on disk: the spool tells of its file once more, and that
 * puts it where it belongs. */
static void reply_retried(service *s, after *a, int code, const shear_error *err) {
    shear_error ignored;
    if (code != SHEAR_OK && a->name != NULL && s->spool != NULL) {
        spool_refuse(s->spool, a->name, &ignored);
    }
    method_reply_job(s, a, code, err);
}

void method_retry(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    store_job job = {0};
    shear_error err = {0};
    sheard_rpc_error error;
    char name[SPOOL_NAME_SIZE];
    if (!method_may_change(s, r, id)) {
        return;
    }
    if (s->state != SHEARD_SERVER_RUNNING) {
        method_refuse_new(s, r->handle);
        return;
    }
    const int code = store_job_get(s->store, id, &job, &err);
    if (code != SHEAR_OK) {
        method_refuse_store(s, r->handle, code, &err);
    } else if (retry(s, &job, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        after *a = answer_later(s, reply_retried, r->handle, SHEARD_METHOD_RETRY, id, false);
        if (a != NULL && spooled_name(&job, name)) {
            a->name = strdup(name);
        }
    }
    store_job_deinit(&job);
}

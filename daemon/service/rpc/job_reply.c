/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/job_reply.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/intake/file_disposal.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_outcome.h"
#include "service/rpc/refuse.h"

void *job_reply_later(service *s, post_commit_run *run, size_t size, server_handle to,
                      int64_t job) {
    job_reply *later = group_then(&s->group, run, job, size);
    if (later == NULL) {
        refuse_with(s, to, SHEARD_RPC_OUT_OF_MEMORY,
                    "out of memory for a reply; the request may have been carried out");
        return NULL;
    }
    later->to = to;
    return later;
}

static void reply_with(service *s, const job_reply *later, const store_job *job) {
    sheard_msg_job message;
    job_to_message(s, job, &message);
    const sheard_reply submitted = {.submit = {.job = message, .known = later->known}};
    const sheard_reply changed = {.cancel = message};
    server_reply(s->server, later->to, later->submit ? &submitted : &changed);
    job_message_deinit(&message);
}

void job_reply_run(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    const job_reply *later = (const job_reply *)post;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error own = {0};
    if (code != SHEAR_OK) {
        refuse_store(s, later->to, code, err);
        return;
    }
    code = store_job_get(s->store, post->job, &job, &own);
    if (code != SHEAR_OK) {
        refuse_store(s, later->to, code, &own);
        return;
    }
    file_disposal_end(s, &job);
    reply_with(s, later, &job);
    job_message_publish(s, &job);
    if (store_state_is_final(job.state))
        job_outcome_tell(s, &job);
}

bool job_reply_may_change(service *s, const server_request *r, int64_t id) {
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error err = {0};
    const int code = store_job_get(s->store, id, &job, &err);
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return false;
    }
    if (job.owner != r->peer->uid && !permissions_is_admin(&s->permissions, r->peer)) {
        refuse_with(s, r->handle, SHEARD_RPC_NOT_OWNER, "the job belongs to somebody else");
        return false;
    }
    return true;
}

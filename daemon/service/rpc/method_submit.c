/* SPDX-License-Identifier: GPL-3.0-or-later */
/* submit: reply when the job is on disk or, if the client waits, when it has ended. */
#include "service/core/parts.h"
#include "service/intake/submission.h"
#include "service/rpc/job_reply.h"
#include "service/rpc/methods.h"
#include "service/rpc/pending_waits.h"
#include "service/rpc/refuse.h"

/* Begin to wait for the end of the job, which is on disk. */
static void reply_when_ended(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    const job_reply *later = (const job_reply *)post;
    if (code != SHEAR_OK) {
        refuse_store(s, later->to, code, err);
        return;
    }
    pending_waits_add_submitted(s, later->to, later->known, post->job);
}

void method_submit(service *s, const server_request *r) {
    const sheard_msg_submit *submit = &r->request->params.submit;
    const submission sub = {
        .submit = submit, .peer = *r->peer, .origin = STORE_SOCKET, .key = submit->key};
    sheard_rpc_error error;
    int64_t id = 0;
    bool known = false;
    if (!permissions_may_submit(&s->permissions, r->peer)) {
        refuse_with(s, r->handle, SHEARD_RPC_NOT_OWNER,
                    "you are in none of the groups that may submit jobs ([access] submit_groups)");
        return;
    }
    if (s->life.state != SHEARD_SERVER_RUNNING) {
        refuse_new_jobs(s, r->handle);
        return;
    }
    if (submission_store(s, &sub, &id, &known, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
        return;
    }
    job_reply *later = job_reply_later(s, submit->wait ? reply_when_ended : job_reply_run,
                                       sizeof *later, r->handle, id);
    if (later != NULL) {
        later->submit = true;
        later->known = known;
    }
}

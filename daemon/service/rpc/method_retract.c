/* SPDX-License-Identifier: GPL-3.0-or-later */
/* retract: what was counted is taken back; answered when that is on disk. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/fields/change_notifier.h"
#include "service/fields/estimates.h"
#include "service/jobs/catalogs.h"
#include "service/rpc/job_reply.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"

/* Then catalogs go, and the field has changed. */
static void reply_retracted(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    job_reply_run(post, code, err);
    if (code != SHEAR_OK) {
        return;
    }
    catalogs_remove_retracted(s);
    if (store_job_get(s->store, post->job, &job, &ignored) == SHEAR_OK) {
        change_notifier_note(s, job.field, job.settings_digest);
    }
}

void method_retract(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    if (!job_reply_may_change(s, r, id)) {
        return;
    }
    int code = group_begin(&s->group, &err);
    if (code == SHEAR_OK) {
        code = store_retract(s->store, id, &err);
    }
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    estimates_note_retraction(s);
    job_reply_later(s, reply_retracted, sizeof(job_reply), r->handle, id);
}

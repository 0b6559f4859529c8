/* SPDX-License-Identifier: GPL-3.0-or-later */
/* retract: what was counted is taken back; answered when that is on disk. */
#include "service/rpc/methods.h"

/* The fields' news, and the catalogs that are to go, come after the commit. */
static void reply_retracted(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error ignored;
    method_reply_job(s, a, code, err);
    if (code == SHEAR_OK) {
        catalogs_remove_retracted(s);
    }
    if (code == SHEAR_OK && store_job_get(s->store, a->job, &job, &ignored) == SHEAR_OK) {
        news_field_changed(s, job.field, job.settings_digest);
    }
    store_job_deinit(&job);
}

void method_retract(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    if (!method_may_change(s, r, id)) {
        return;
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_retract(s->store, id, &err);
    }
    after *a = code == SHEAR_OK ? group_after(s, reply_retracted) : NULL;
    if (code != SHEAR_OK || a == NULL) {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
        return;
    }
    s->retractions++;
    a->to = r->handle;
    a->method = SHEARD_METHOD_RETRACT;
    a->job = id;
}

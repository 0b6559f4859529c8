/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cancel: answered when it is on disk. */
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/rpc/job_reply.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"

void method_cancel(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    if (!job_reply_may_change(s, r, id)) {
        return;
    }
    int code = group_begin(&s->group, &err);
    if (code == SHEAR_OK) {
        code = store_cancel(s->store, id, clock_wall_ms(), &state, &err);
    }
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    if (state == STORE_RUNNING) {
        engine_stop_job(s->engine, id);
    }
    job_reply_later(s, job_reply_run, sizeof(job_reply), r->handle, id);
}

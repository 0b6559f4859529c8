/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/methods.h"

#include "service/core/parts.h"
#include "service/rpc/refuse.h"

#include <assert.h>

static method_handler *const handlers[SHEARD_N_METHODS] = {
    [SHEARD_METHOD_HELLO] = method_hello,
    [SHEARD_METHOD_SUBMIT] = method_submit,
    [SHEARD_METHOD_JOB] = method_job,
    [SHEARD_METHOD_JOBS] = method_jobs,
    [SHEARD_METHOD_WAIT] = method_wait,
    [SHEARD_METHOD_CANCEL] = method_cancel,
    [SHEARD_METHOD_RETRY] = method_retry,
    [SHEARD_METHOD_RETRACT] = method_retract,
    [SHEARD_METHOD_FIELD] = method_field,
    [SHEARD_METHOD_FIELDS] = method_fields,
    [SHEARD_METHOD_FORGET] = method_forget,
    [SHEARD_METHOD_SUBSCRIBE] = method_subscribe,
    [SHEARD_METHOD_UNSUBSCRIBE] = method_unsubscribe,
    [SHEARD_METHOD_STATUS] = method_status,
    [SHEARD_METHOD_METRICS] = method_metrics,
    [SHEARD_METHOD_PROBE] = method_probe,
    [SHEARD_METHOD_RELOAD] = method_reload,
    [SHEARD_METHOD_DRAIN] = method_drain,
    [SHEARD_METHOD_SHUTDOWN] = method_shutdown,
};

void methods_request(void *context, const server_request *r) {
    service *s = context;
    const int method = r->request->method;
    assert(method >= 0 && method < SHEARD_N_METHODS && handlers[method] != NULL);
    if (sheard_method_needs_admin(method) && !permissions_admin(&s->permissions, r->peer)) {
        refuse_with(s, r->handle, SHEARD_RPC_NOT_ADMIN,
                    "only administrators may do this ([access] admin_users, admin_groups)");
        return;
    }
    handlers[method](s, r);
}

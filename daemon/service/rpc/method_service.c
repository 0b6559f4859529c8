/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status, reload, drain, shutdown: methods that concern the service as a whole. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/core/reload.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/methods.h"
#include "service/rpc/status.h"

int method_status(service *s, const server_request *r, sheard_rpc_error *error) {
    CLEANUP(release_free) status *st = NULL;
    shear_error err = {0};
    TRY(rpc_error_from_store(error, status_new(&st, s, &err), &err));
    const sheard_reply reply = {.status = st->message};
    server_reply(s->server, r->handle, &reply);
    return SHEARD_RPC_OK;
}

int method_reload(service *s, const server_request *r, sheard_rpc_error *error) {
    sheard_reply reply = {0};
    TRY(reload_config(s, &reply.reload, error));
    server_reply(s->server, r->handle, &reply);
    reload_reply_deinit(&reply.reload);
    return SHEARD_RPC_OK;
}

static void reply_state(service *s, server_handle to) {
    const sheard_reply reply = {.drain = lifecycle_get(s)}; /* shutdown's reply has the same type */
    server_reply(s->server, to, &reply);
}

int method_drain(service *s, const server_request *r, sheard_rpc_error *error) {
    (void)error;
    lifecycle_drain(s);
    reply_state(s, r->handle);
    lifecycle_announce(s);
    return SHEARD_RPC_OK;
}

int method_shutdown(service *s, const server_request *r, sheard_rpc_error *error) {
    (void)error;
    if (r->request->params.shutdown.mode == SHEARD_SHUTDOWN_NOW) {
        lifecycle_stop_now(s);
    } else {
        lifecycle_stop(s, r->request->params.shutdown.timeout_s);
    }
    reply_state(s, r->handle);
    return SHEARD_RPC_OK;
}

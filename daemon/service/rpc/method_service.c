/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status, metrics, reload, drain, shutdown: methods that concern the service as a whole. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/core/reload.h"
#include "service/rpc/methods.h"
#include "service/rpc/metrics.h"
#include "service/rpc/refuse.h"
#include "service/rpc/status.h"

void method_status(service *s, const server_request *r) {
    CLEANUP(status_deinit) status st = {.problems = NULL};
    shear_error err = {0};
    const int code = status_init(&st, s, &err);
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    const sheard_reply reply = {.status = st.message};
    server_reply(s->server, r->handle, &reply);
}

static int metrics_text(service *s, char **text, shear_error *err) {
    CLEANUP(status_deinit) status st = {.problems = NULL};
    server_statistics net;
    size_t size = 0;
    TRY(status_init(&st, s, err));
    FILE *out = open_memstream(text, &size);
    if (out != NULL) {
        server_get_statistics(s->server, &net);
        metrics_write(out, &st, &net);
    }
    return out != NULL && fclose(out) == 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the metrics");
}

void method_metrics(service *s, const server_request *r) {
    CLEANUP(release_free) char *text = NULL;
    shear_error err = {0};
    const int code = metrics_text(s, &text, &err);
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    const sheard_reply reply = {
        .metrics = {.content_type = "text/plain; version=0.0.4; charset=utf-8", .text = text}};
    server_reply(s->server, r->handle, &reply);
}

void method_reload(service *s, const server_request *r) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    if (reload_config(s, &reply.reload, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
        return;
    }
    server_reply(s->server, r->handle, &reply);
    reload_reply_deinit(&reply.reload);
}

static void reply_state(service *s, server_handle to) {
    const sheard_reply reply = {.drain = lifecycle_get(s)}; /* shutdown's reply has the same type */
    server_reply(s->server, to, &reply);
}

void method_drain(service *s, const server_request *r) {
    lifecycle_drain(s);
    reply_state(s, r->handle);
    lifecycle_announce(s);
}

void method_shutdown(service *s, const server_request *r) {
    if (r->request->params.shutdown.mode == SHEARD_SHUTDOWN_NOW) {
        lifecycle_stop_now(s);
    } else {
        lifecycle_stop(s, r->request->params.shutdown.timeout_s);
    }
    reply_state(s, r->handle);
}

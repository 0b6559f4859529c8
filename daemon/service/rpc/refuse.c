/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/refuse.h"

#include "service/core/parts.h"
#include "service/jobs/rpc_errors.h"

void refuse_with(service *s, server_handle to, int code, const char *message) {
    sheard_rpc_error error;
    sheard_rpc_fail(&error, code, NULL, "%s", message);
    server_reply_error(s->server, to, &error);
}

void refuse_store(service *s, server_handle to, int code, const shear_error *err) {
    sheard_rpc_error error;
    rpc_error_from_store(&error, code, err);
    server_reply_error(s->server, to, &error);
}

void refuse_new_jobs(service *s, server_handle to) {
    refuse_with(s, to,
                s->life.state == SHEARD_SERVER_DRAINING ? SHEARD_RPC_DRAINING : SHEARD_RPC_STOPPING,
                "the service takes no new jobs");
}

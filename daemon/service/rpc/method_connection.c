/* SPDX-License-Identifier: GPL-3.0-or-later */
/* hello, subscribe, unsubscribe: methods that concern the connection. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/methods.h"
#include "service/rpc/status.h"
#include "shear/version.h"

int method_hello(service *s, const server_request *r, sheard_rpc_error *error) {
    const sheard_msg_hello *hello = &r->request->params.hello;
    if (hello->oldest > SHEARD_PROTOCOL_VERSION || hello->newest < SHEARD_PROTOCOL_OLDEST) {
        return sheard_rpc_fail(error, SHEARD_RPC_UNSUPPORTED_VERSION, NULL,
                               "client and service speak no common version of the protocol");
    }
    sheard_reply reply = {.hello = {.protocol = SHEARD_PROTOCOL_VERSION,
                                    .oldest = SHEARD_PROTOCOL_OLDEST,
                                    .newest = SHEARD_PROTOCOL_VERSION,
                                    .server = "sheard " SHEAR_VERSION_STRING,
                                    .uid = r->peer->uid,
                                    .admin = permissions_is_admin(&s->permissions, r->peer)}};
    reply.hello.methods = sheard_method_names(&reply.hello.n_methods);
    reply.hello.limits = status_limits(s);
    server_reply(s->server, r->handle, &reply);
    return SHEARD_RPC_OK;
}

/* Check that all jobs exist. */
static int check_jobs(service *s, const int64_t *ids, size_t n, sheard_rpc_error *error) {
    for (size_t i = 0; i < n; i++) {
        shear_error err = {0};
        enum store_state state;
        TRY(rpc_error_from_store(error, store_job_state(s->store, ids[i], &state, &err), &err));
    }
    return SHEARD_RPC_OK;
}

/* Unsubscribe from jobs that are already final: nothing will be published about them. */
static void leave_final(service *s, uint64_t connection, const sheard_msg_subscribe *what,
                        sheard_msg_subscribed *now) {
    for (size_t i = 0; i < what->n_jobs; i++) {
        enum store_state state;
        shear_error ignored;
        sheard_rpc_error error;
        if (store_job_state(s->store, what->jobs[i], &state, &ignored) == SHEAR_OK &&
            store_state_is_final(state)) {
            const sheard_msg_subscribe one = {.jobs = &what->jobs[i], .n_jobs = 1};
            server_unsubscribe(s->server, connection, &one, now, &error);
        }
    }
}

int method_subscribe(service *s, const server_request *r, sheard_rpc_error *error) {
    const sheard_msg_subscribe *what = &r->request->params.subscribe;
    const uint64_t connection = r->handle.connection;
    sheard_reply reply = {0};
    TRY(check_jobs(s, what->jobs, what->n_jobs, error));
    TRY(server_subscribe(s->server, connection, what, &reply.subscribe, error));
    leave_final(s, connection, what, &reply.subscribe);
    server_reply(s->server, r->handle, &reply);
    return SHEARD_RPC_OK;
}

int method_unsubscribe(service *s, const server_request *r, sheard_rpc_error *error) {
    sheard_reply reply = {0};
    TRY(server_unsubscribe(s->server, r->handle.connection, &r->request->params.subscribe,
                           &reply.unsubscribe, error));
    server_reply(s->server, r->handle, &reply);
    return SHEARD_RPC_OK;
}

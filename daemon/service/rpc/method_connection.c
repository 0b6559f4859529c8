/* SPDX-License-Identifier: GPL-3.0-or-later */
/* hello, subscribe, unsubscribe: methods that concern the connection. */
#include "service/core/parts.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"
#include "service/rpc/status.h"
#include "shear/version.h"

void method_hello(service *s, const server_request *r) {
    const sheard_msg_hello *hello = &r->request->params.hello;
    if (hello->oldest > SHEARD_PROTOCOL_VERSION || hello->newest < SHEARD_PROTOCOL_OLDEST) {
        refuse_with(s, r->handle, SHEARD_RPC_UNSUPPORTED_VERSION,
                    "client and service speak no common version of the protocol");
        return;
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
}

/* Return true if all jobs exist. Otherwise the error reply has been sent. */
static bool jobs_known(service *s, const server_request *r, const int64_t *ids, size_t n) {
    for (size_t i = 0; i < n; i++) {
        shear_error err = {0};
        enum store_state state;
        const int code = store_job_state(s->store, ids[i], &state, &err);
        if (code != SHEAR_OK) {
            refuse_store(s, r->handle, code, &err);
            return false;
        }
    }
    return true;
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

void method_subscribe(service *s, const server_request *r) {
    const sheard_msg_subscribe *what = &r->request->params.subscribe;
    sheard_rpc_error error;
    sheard_reply reply = {0};
    if (!jobs_known(s, r, what->jobs, what->n_jobs))
        return;
    if (server_subscribe(s->server, r->handle.connection, what, &reply.subscribe, &error) !=
        SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
        return;
    }
    leave_final(s, r->handle.connection, what, &reply.subscribe);
    server_reply(s->server, r->handle, &reply);
}

void method_unsubscribe(service *s, const server_request *r) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    if (server_unsubscribe(s->server, r->handle.connection, &r->request->params.subscribe,
                           &reply.unsubscribe, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
        return;
    }
    server_reply(s->server, r->handle, &reply);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which method does what, error replies, and the methods that concern a connection or the service.
 */
#include "service/rpc/methods.h"

#include <stdlib.h>

bool peer_is_admin(const service *s, const access_peer *peer) {
    return peer->uid == 0 || access_list_has(s->admins, peer);
}

void method_refuse(service *s, server_handle to, int code, const char *message) {
    sheard_rpc_error error;
    sheard_rpc_fail(&error, code, NULL, "%s", message);
    server_reply_error(s->server, to, &error);
}

void method_refuse_new(service *s, server_handle to) {
    method_refuse(s, to,
                  s->state == SHEARD_SERVER_DRAINING ? SHEARD_RPC_DRAINING : SHEARD_RPC_STOPPING,
                  "the service takes no new jobs");
}

void method_refuse_store(service *s, server_handle to, int code, const shear_error *err) {
    sheard_rpc_error error;
    rpc_from_store(&error, code, err);
    server_reply_error(s->server, to, &error);
}

/* ---- looking ---- */

static void do_hello(service *s, const server_request *r) {
    const sheard_msg_hello *hello = &r->request->params.hello;
    if (hello->oldest > SHEARD_PROTOCOL_VERSION || hello->newest < SHEARD_PROTOCOL_OLDEST) {
        method_refuse(s, r->handle, SHEARD_RPC_UNSUPPORTED_VERSION,
                      "client and service speak no common version of the protocol");
        return;
    }
    sheard_reply reply = {.hello = {.protocol = SHEARD_PROTOCOL_VERSION,
                                    .oldest = SHEARD_PROTOCOL_OLDEST,
                                    .newest = SHEARD_PROTOCOL_VERSION,
                                    .server = "sheard " SHEARD_VERSION,
                                    .uid = r->peer->uid,
                                    .admin = peer_is_admin(s, r->peer)}};
    reply.hello.methods = sheard_method_names(&reply.hello.n_methods);
    reply.hello.limits = status_limits(s);
    server_reply(s->server, r->handle, &reply);
}

/* Where one of the jobs is unknown, the reply has been given. */
static bool jobs_known(service *s, const server_request *r, const int64_t *ids, size_t n) {
    for (size_t i = 0; i < n; i++) {
        shear_error err = {0};
        enum store_state state;
        const int code = store_job_state(s->store, ids[i], &state, &err);
        if (code != SHEAR_OK) {
            method_refuse_store(s, r->handle, code, &err);
            return false;
        }
    }
    return true;
}

/* Of jobs that are final already nothing will be told. */
static void leave_final(service *s, uint64_t connection, const sheard_msg_subscribe *what,
                        sheard_msg_subscribed *now) {
    for (size_t i = 0; i < what->n_jobs; i++) {
        enum store_state state;
        shear_error ignored;
        sheard_rpc_error error;
        if (store_job_state(s->store, what->jobs[i], &state, &ignored) == SHEAR_OK &&
            sheard_job_state_is_final(state)) {
            const sheard_msg_subscribe one = {.jobs = &what->jobs[i], .n_jobs = 1};
            server_unsubscribe(s->server, connection, &one, now, &error);
        }
    }
}

static void do_subscribe(service *s, const server_request *r, bool add) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    const uint64_t connection = r->handle.connection;
    const sheard_msg_subscribe *what = &r->request->params.subscribe;
    if (add && !jobs_known(s, r, what->jobs, what->n_jobs)) {
        return;
    }
    const int code =
        add ? server_subscribe(s->server, connection, what, &reply.subscribe, &error)
            : server_unsubscribe(s->server, connection, what, &reply.unsubscribe, &error);
    if (code != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        if (add) {
            leave_final(s, connection, what, &reply.subscribe);
        }
        server_reply(s->server, r->handle, &reply);
    }
}

/* ---- administration ---- */

static void do_reload(service *s, const server_request *r) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    if (reload_config(s, &reply.reload, &error) != SHEARD_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        server_reply(s->server, r->handle, &reply);
    }
    reload_reply_deinit(&reply.reload);
}

static void do_stop(service *s, const server_request *r) {
    if (r->request->method == SHEARD_METHOD_DRAIN) {
        life_drain_queue(s);
    } else if (r->request->params.shutdown.mode == SHEARD_SHUTDOWN_NOW) {
        life_stop_now(s);
    } else {
        life_drain(s, r->request->params.shutdown.timeout_s);
    }
    const sheard_reply reply = {.drain = life_left(s)};
    server_reply(s->server, r->handle, &reply);
    if (r->request->method == SHEARD_METHOD_DRAIN) {
        life_announce(s);
    }
}

void methods_request(void *context, const server_request *r) {
    service *s = context;
    const int method = r->request->method;
    if (sheard_method_needs_admin(method) && !peer_is_admin(s, r->peer)) {
        method_refuse(s, r->handle, SHEARD_RPC_NOT_ADMIN,
                      "only administrators may do this ([access] admin_users, admin_groups)");
        return;
    }
    switch (method) {
    case SHEARD_METHOD_HELLO:
        do_hello(s, r);
        break;
    case SHEARD_METHOD_SUBMIT:
        method_submit(s, r);
        break;
    case SHEARD_METHOD_JOB:
        method_job(s, r);
        break;
    case SHEARD_METHOD_JOBS:
        method_jobs(s, r);
        break;
    case SHEARD_METHOD_WAIT:
        method_wait(s, r);
        break;
    case SHEARD_METHOD_CANCEL:
        method_cancel(s, r);
        break;
    case SHEARD_METHOD_RETRY:
        method_retry(s, r);
        break;
    case SHEARD_METHOD_RETRACT:
        method_retract(s, r);
        break;
    case SHEARD_METHOD_FORGET:
        method_forget(s, r);
        break;
    case SHEARD_METHOD_FIELD:
        method_field(s, r);
        break;
    case SHEARD_METHOD_FIELDS:
        method_fields(s, r);
        break;
    case SHEARD_METHOD_SUBSCRIBE:
    case SHEARD_METHOD_UNSUBSCRIBE:
        do_subscribe(s, r, method == SHEARD_METHOD_SUBSCRIBE);
        break;
    case SHEARD_METHOD_STATUS:
        status_reply(s, r->handle);
        break;
    case SHEARD_METHOD_PROBE:
        method_probe(s, r);
        break;
    case SHEARD_METHOD_METRICS:
        metrics_reply(s, r->handle);
        break;
    case SHEARD_METHOD_RELOAD:
        do_reload(s, r);
        break;
    default:
        do_stop(s, r);
        break;
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/methods.h"

#include "service/core/parts.h"
#include "service/rpc/refuse.h"

#include <assert.h>

static method_handler *const handlers[SHEARD_N_METHODS] = {
#define METHOD(NAME, name, params, reply, admin) method_##name,
    SHEARD_METHODS(METHOD)
#undef METHOD
};

void methods_request(void *context, const server_request *r) {
    service *s = context;
    const int method = r->request->method;
    assert(method >= 0 && method < SHEARD_N_METHODS);
    if (sheard_method_needs_admin(method) && !permissions_is_admin(&s->permissions, r->peer)) {
        refuse_with(s, r->handle, SHEARD_RPC_NOT_ADMIN,
                    "only administrators may do this ([access] admin_users, admin_groups)");
        return;
    }
    handlers[method](s, r);
}

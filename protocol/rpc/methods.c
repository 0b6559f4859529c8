/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rpc/methods.h"

#include <string.h>

const rpc_method rpc_methods[SHEARD_N_METHODS] = {
#define METHOD(NAME, name, params, reply, admin) {#name, &msg_##params, &msg_##reply, admin},
    SHEARD_METHODS(METHOD)
#undef METHOD
};

const rpc_notice rpc_notices[SHEARD_N_NOTICES] = {
#define NOTICE(NAME, name, params) {#name, &msg_##params},
    SHEARD_NOTICES(NOTICE)
#undef NOTICE
};

static const char *const method_names[SHEARD_N_METHODS] = {
#define METHOD(NAME, name, params, reply, admin) #name,
    SHEARD_METHODS(METHOD)
#undef METHOD
};

static bool is_method(int method) {
    return method >= 0 && method < SHEARD_N_METHODS;
}

const char *sheard_method_name(int method) {
    return is_method(method) ? rpc_methods[method].name : NULL;
}

const char *sheard_notice_name(int notice) {
    return notice >= 0 && notice < SHEARD_N_NOTICES ? rpc_notices[notice].name : NULL;
}

enum sheard_method sheard_method_find(const char *name) {
    for (int i = 0; i < SHEARD_N_METHODS; i++) {
        if (strcmp(rpc_methods[i].name, name) == 0)
            return i;
    }
    return SHEARD_METHOD_NONE;
}

enum sheard_notice sheard_notice_find(const char *name) {
    for (int i = 0; i < SHEARD_N_NOTICES; i++) {
        if (strcmp(rpc_notices[i].name, name) == 0)
            return i;
    }
    return SHEARD_NOTICE_NONE;
}

bool sheard_method_needs_admin(int method) {
    return is_method(method) && rpc_methods[method].admin;
}

const char *const *sheard_method_names(size_t *n) {
    *n = SHEARD_N_METHODS;
    return method_names;
}

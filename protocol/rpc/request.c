/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon reads a request. */
#include "rpc/envelope.h"
#include "rpc/methods.h"

#include <stdio.h>
#include <string.h>

static int invalid(sheard_rpc_error *error, const char *said) {
    return sheard_rpc_fail(error, SHEARD_RPC_INVALID_REQUEST, NULL, "%s", said);
}

static int check_shape(const json_t *root, sheard_rpc_error *error) {
    if (json_is_array(root)) {
        return sheard_rpc_fail(error, SHEARD_RPC_BATCH_UNSUPPORTED, NULL,
                               "a batch of requests is not taken");
    }
    return json_is_object(root) ? SHEARD_RPC_OK : invalid(error, "a request is an object");
}

static int check_envelope(json_t *root, sheard_rpc_error *error) {
    static const char *const known[] = {"jsonrpc", "id", "method", "params"};
    for (void *i = json_object_iter(root); i; i = json_object_iter_next(root, i)) {
        size_t k = 0;
        while (k < 4 && strcmp(known[k], json_object_iter_key(i)) != 0) {
            k++;
        }
        if (k == 4) {
            return sheard_rpc_fail(error, SHEARD_RPC_INVALID_REQUEST, NULL,
                                   "a request has no member \"%.60s\"", json_object_iter_key(i));
        }
    }
    const char *version = json_string_value(json_object_get(root, "jsonrpc"));
    if (version == NULL || strcmp(version, "2.0") != 0) {
        return invalid(error, "\"jsonrpc\" must be \"2.0\"");
    }
    return SHEARD_RPC_OK;
}

static int read_id(sheard_rpc_id *id, const json_t *root, sheard_rpc_error *error) {
    const json_t *value = json_object_get(root, "id");
    if (value == NULL) {
        return invalid(error, "\"id\" is missing: every request is answered");
    }
    return rpc_id_read(id, value)
               ? SHEARD_RPC_OK
               : invalid(error,
                         "\"id\" must be a whole number, null, or a string of at most 128 bytes");
}

static int read_method(int *method, const json_t *root, sheard_rpc_error *error) {
    const json_t *value = json_object_get(root, "method");
    if (!json_is_string(value)) {
        return invalid(error, "\"method\" must be a string");
    }
    const char *name = json_string_value(value);
    *method = strlen(name) == json_string_length(value) ? sheard_method_find(name) : -1;
    return *method >= 0 ? SHEARD_RPC_OK
                        : sheard_rpc_fail(error, SHEARD_RPC_UNKNOWN_METHOD, NULL,
                                          "there is no method \"%.60s\"", name);
}

/* The settings that were given, upon those of the service. */
static int check_settings(const sheard_msg_submit *submit, const shear_settings *defaults,
                          sheard_rpc_error *error) {
    shear_settings s;
    shear_settings_init(&s);
    if (defaults != NULL) {
        s = *defaults;
    }
    shear_error core = {0};
    if (sheard_settings_apply(&s, submit->settings, &core) == SHEAR_OK) {
        return SHEARD_RPC_OK;
    }
    sheard_rpc_fail_core(error, &core);
    snprintf(error->parameter, sizeof error->parameter, "settings");
    return error->code;
}

int rpc_read_submit(sheard_msg_submit *submit, const json_t *params, const shear_settings *defaults,
                    sheard_rpc_error *error) {
    int rc = msg_read(submit, &msg_submit, params, MSG_STRICT, error);
    if (rc == SHEARD_RPC_OK) {
        rc = check_settings(submit, defaults, error);
        if (rc != SHEARD_RPC_OK) {
            msg_deinit(submit, &msg_submit);
        }
    }
    return rc;
}

static int read_params(sheard_params *params, int method, const json_t *root,
                       const shear_settings *defaults, sheard_rpc_error *error) {
    const json_t *given = json_object_get(root, "params");
    if (json_is_null(given)) {
        given = NULL;
    }
    if (given != NULL && !json_is_object(given)) {
        sheard_rpc_fail(error, SHEARD_RPC_BAD_PARAMETER, "name the parameters: {\"id\": 1}",
                        "'params': expected an object, not %s", msg_kind(given));
        snprintf(error->parameter, sizeof error->parameter, "params");
        return error->code;
    }
    return method == SHEARD_METHOD_SUBMIT
               ? rpc_read_submit(&params->submit, given, defaults, error)
               : msg_read(params, rpc_methods[method].params, given, MSG_STRICT, error);
}

int sheard_request_parse(sheard_request *request, const char *line, size_t n,
                         const shear_settings *defaults, sheard_rpc_error *error) {
    int method = -1;
    *error = (sheard_rpc_error){.code = SHEARD_RPC_OK};
    memset(request, 0, sizeof *request);
    json_t *root = rpc_read_line(line, n, &sheard_rpc_request_limits, &request->id, error);
    int rc = root != NULL ? check_shape(root, error) : error->code;
    rc = rc != 0 ? rc : read_id(&request->id, root, error);
    rc = rc != 0 ? rc : check_envelope(root, error);
    rc = rc != 0 ? rc : read_method(&method, root, error);
    rc = rc != 0 ? rc : read_params(&request->params, method, root, defaults, error);
    request->method = rc != 0 ? -1 : method;
    json_decref(root);
    return rc;
}

void sheard_request_deinit(sheard_request *request) {
    if (request->method >= 0 && request->method < SHEARD_N_METHODS) {
        msg_deinit(&request->params, rpc_methods[request->method].params);
    }
    memset(request, 0, sizeof *request);
}

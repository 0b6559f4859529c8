/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parse a request, for the daemon. */
#include "rpc/envelope.h"

#include "base/cleanup.h"
#include "rpc/methods.h"
#include "rpc/submit.h"

#include <string.h>

static int invalid(sheard_rpc_error *error, const char *said) {
    return sheard_rpc_fail(error, SHEARD_RPC_INVALID_REQUEST, NULL, "%s", said);
}

static int check_shape(const json_t *root, sheard_rpc_error *error) {
    if (json_is_array(root)) {
        return sheard_rpc_fail(error, SHEARD_RPC_BATCH_UNSUPPORTED, NULL,
                               "batches of requests are not accepted");
    }
    return json_is_object(root) ? SHEARD_RPC_OK : invalid(error, "a request is an object");
}

static bool is_known_member(const char *name) {
    static const char *const known[] = {"jsonrpc", "id", "method", "params"};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(known[i], name) == 0)
            return true;
    }
    return false;
}

static int check_envelope(json_t *root, sheard_rpc_error *error) {
    for (void *i = json_object_iter(root); i != NULL; i = json_object_iter_next(root, i)) {
        if (!is_known_member(json_object_iter_key(i))) {
            return sheard_rpc_fail(error, SHEARD_RPC_INVALID_REQUEST, NULL,
                                   "a request has no member \"%.60s\"", json_object_iter_key(i));
        }
    }
    return rpc_is_2_0(root) ? SHEARD_RPC_OK : invalid(error, "\"jsonrpc\" must be \"2.0\"");
}

static int read_id(sheard_rpc_id *id, const json_t *root, sheard_rpc_error *error) {
    const json_t *value = json_object_get(root, "id");
    if (value == NULL)
        return invalid(error, "\"id\" is missing: every request is answered");
    return rpc_id_read(id, value)
               ? SHEARD_RPC_OK
               : invalid(error,
                         "\"id\" must be a whole number, null, or a string of at most 128 bytes");
}

static int read_method(enum sheard_method *method, const json_t *root, sheard_rpc_error *error) {
    const json_t *value = json_object_get(root, "method");
    if (!json_is_string(value))
        return invalid(error, "\"method\" must be a string");
    const char *name = json_string_value(value);
    if (strlen(name) == json_string_length(value))
        *method = sheard_method_find(name);
    return *method != SHEARD_METHOD_NONE ? SHEARD_RPC_OK
                                         : sheard_rpc_fail(error, SHEARD_RPC_UNKNOWN_METHOD, NULL,
                                                           "there is no method \"%.60s\"", name);
}

static int read_params(sheard_params *params, enum sheard_method method, const json_t *root,
                       const shear_settings *defaults, sheard_rpc_error *error) {
    const json_t *given = json_object_get(root, "params");
    if (json_is_null(given))
        given = NULL;
    if (given != NULL && !json_is_object(given)) {
        return sheard_rpc_fail_parameter(error, SHEARD_RPC_BAD_PARAMETER, "params",
                                         "name the parameters: {\"id\": 1}",
                                         "expected an object, not %s", json_text_kind(given));
    }
    return method == SHEARD_METHOD_SUBMIT
               ? submit_read(&params->submit, given, defaults, error)
               : msg_read(params, rpc_methods[method].params, given, MSG_STRICT, error);
}

/* Read the request. The id is read first, so that errors in the rest are reported with it. */
static int read_request(sheard_request *request, json_t *root, const shear_settings *defaults,
                        sheard_rpc_error *error) {
    enum sheard_method method = SHEARD_METHOD_NONE;
    TRY(check_shape(root, error));
    TRY(read_id(&request->id, root, error));
    TRY(check_envelope(root, error));
    TRY(read_method(&method, root, error));
    TRY(read_params(&request->params, method, root, defaults, error));
    request->method = method;
    return SHEARD_RPC_OK;
}

int sheard_request_parse(sheard_request *request, const char *line, size_t n,
                         const shear_settings *defaults, sheard_rpc_error *error) {
    memset(request, 0, sizeof *request);
    request->method = SHEARD_METHOD_NONE;
    json_auto_t *root = rpc_read_line(line, n, &sheard_rpc_request_limits, &request->id, error);
    return root != NULL ? read_request(request, root, defaults, error) : error->code;
}

void sheard_request_deinit(sheard_request *request) {
    if (sheard_method_name(request->method) != NULL)
        msg_deinit(&request->params, rpc_methods[request->method].params);
    memset(request, 0, sizeof *request);
}

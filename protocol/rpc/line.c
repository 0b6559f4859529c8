/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write messages as lines: requests of the client; replies, errors and notifications of the daemon.
 */
#include "rpc/envelope.h"
#include "rpc/methods.h"

#include <stdlib.h>
#include <string.h>

const char sheard_rpc_no_memory_line[] =
    "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32019,\"message\":\"out of memory\","
    "\"data\":{\"code\":\"out_of_memory\",\"retry\":true,\"parameter\":null,"
    "\"advice\":\"try again when the machine has more memory free\"}}}\n";

static int bad_call(sheard_rpc_error *error, const char *what, int number) {
    return sheard_rpc_fail(error, SHEARD_RPC_INTERNAL, NULL, "there is no %s number %d", what,
                           number);
}

void sheard_params_init(sheard_params *params, int method) {
    memset(params, 0, sizeof *params);
    if (sheard_method_name(method) != NULL)
        msg_init(params, rpc_methods[method].params);
}

/* Check the parameters as the daemon will. */
static int check_as_daemon(int method, const json_t *params, sheard_rpc_error *error) {
    sheard_params parsed;
    const msg_table *table = rpc_methods[method].params;
    const int code = msg_read(&parsed, table, params, MSG_STRICT, error);
    if (code == SHEARD_RPC_OK)
        msg_deinit(&parsed, table);
    return code;
}

/* Check the length: escapes may make a line longer than its parameters are. */
static int check_length(char **line, size_t *n, sheard_rpc_error *error) {
    const size_t length = *n - 1;
    if (length <= sheard_rpc_request_limits.line)
        return SHEARD_RPC_OK;
    free(*line);
    *line = NULL;
    *n = 0;
    return sheard_rpc_fail(error, SHEARD_RPC_LINE_TOO_LONG, NULL,
                           "%zu bytes; at most %zu are accepted", length,
                           sheard_rpc_request_limits.line);
}

/* Write a line with the id and one more member; a NULL value means out of memory. */
static int write_answer(char **line, size_t *n, const sheard_rpc_id *id, const char *key,
                        json_t *value, sheard_rpc_error *error) {
    json_t *answer =
        JSON_OBJECT({"jsonrpc", json_string("2.0")}, {"id", rpc_id_write(id)}, {key, value});
    return rpc_write_line(line, n, answer, error);
}

int sheard_request_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                        const sheard_params *params, sheard_rpc_error *error) {
    sheard_params none;
    *line = NULL;
    *n = 0;
    if (sheard_method_name(method) == NULL)
        return bad_call(error, "method", method);
    sheard_params_init(&none, method);
    json_t *object =
        msg_write(params != NULL ? params : &none, rpc_methods[method].params, MSG_SPARSE, error);
    if (object == NULL)
        return error->code;
    int code = check_as_daemon(method, object, error);
    if (code != SHEARD_RPC_OK) {
        json_decref(object);
        return code;
    }
    json_t *request =
        JSON_OBJECT({"jsonrpc", json_string("2.0")}, {"id", rpc_id_write(id)},
                    {"method", json_string(rpc_methods[method].name)}, {"params", object});
    code = rpc_write_line(line, n, request, error);
    return code == SHEARD_RPC_OK ? check_length(line, n, error) : code;
}

int sheard_reply_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                      const sheard_reply *reply, sheard_rpc_error *error) {
    *line = NULL;
    *n = 0;
    if (sheard_method_name(method) == NULL)
        return bad_call(error, "method", method);
    json_t *result = msg_write(reply, rpc_methods[method].reply, 0, error);
    return result != NULL ? write_answer(line, n, id, "result", result, error) : error->code;
}

int sheard_error_line(char **line, size_t *n, const sheard_rpc_id *id,
                      const sheard_rpc_error *what) {
    const char *parameter = what->parameter[0] != '\0' ? what->parameter : NULL;
    sheard_rpc_error no_memory;
    json_t *data = JSON_OBJECT(
        {"code", json_text_string(what->name)}, {"retry", json_boolean(what->retry)},
        {"parameter", json_text_string(parameter)}, {"advice", json_text_string(what->advice)});
    json_t *error = JSON_OBJECT({"code", json_integer(what->number)},
                                {"message", json_text_string(what->message)}, {"data", data});
    return write_answer(line, n, id, "error", error, &no_memory);
}

int sheard_notice_line(char **line, size_t *n, int notice, const sheard_notice_params *params,
                       sheard_rpc_error *error) {
    *line = NULL;
    *n = 0;
    if (sheard_notice_name(notice) == NULL)
        return bad_call(error, "notification", notice);
    json_t *object = msg_write(params, rpc_notices[notice].params, 0, error);
    if (object == NULL)
        return error->code;
    json_t *told =
        JSON_OBJECT({"jsonrpc", json_string("2.0")},
                    {"method", json_string(rpc_notices[notice].name)}, {"params", object});
    return rpc_write_line(line, n, told, error);
}

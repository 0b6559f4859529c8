/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The client reads what the daemon says. */
#include "rpc_dump.h"
#include "rpc_envelope.h"
#include "rpc_methods.h"

#include <stdio.h>
#include <string.h>

static int bad_reply(shear_rpc_error *error, const char *said) {
    return shear_rpc_fail(error, SHEAR_RPC_BAD_REPLY, NULL, "the service's answer %s", said);
}

static void copy_text(char *buf, size_t size, const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    snprintf(buf, size, "%s", text ? text : "");
}

static int read_error(shear_rpc_error *said, const json_t *value, shear_rpc_error *error) {
    const json_t *number = json_object_get(value, "code");
    const json_t *data = json_object_get(value, "data");
    if (!json_is_object(value) || !json_is_integer(number) ||
        !json_is_string(json_object_get(value, "message")) || (data && !json_is_object(data))) {
        return bad_reply(error, "has an error without code and message");
    }
    *said = (shear_rpc_error){.retry = json_is_true(json_object_get(data, "retry"))};
    const json_int_t given = json_integer_value(number);
    said->number = given < INT32_MIN || given > INT32_MAX ? 0 : (int)given;
    copy_text(said->name, sizeof said->name, data, "code");
    copy_text(said->parameter, sizeof said->parameter, data, "parameter");
    copy_text(said->advice, sizeof said->advice, data, "advice");
    copy_text(said->message, sizeof said->message, value, "message");
    said->code = shear_rpc_code_find(said->name);
    if (said->code == SHEAR_RPC_OK) { /* an error all the same */
        said->code = SHEAR_RPC_UNKNOWN;
    }
    return SHEAR_RPC_OK;
}

static int read_notice(shear_message *m, const json_t *root, shear_rpc_error *error) {
    const char *name = json_string_value(json_object_get(root, "method"));
    m->kind = SHEAR_MESSAGE_NOTICE;
    m->notice = -1;
    for (int i = 0; name && i < SHEAR_N_NOTICES; i++) {
        if (strcmp(rpc_notices[i].name, name) == 0) {
            const int rc = msg_read(&m->params, rpc_notices[i].params,
                                    json_object_get(root, "params"), 0, error);
            m->notice = rc == SHEAR_RPC_OK ? i : -1;
            return rc;
        }
    }
    return name ? SHEAR_RPC_OK : bad_reply(error, "has a method that is no string");
}

static int read_answer(shear_message *m, const json_t *root, shear_rpc_error *error) {
    json_t *result = json_object_get(root, "result");
    json_t *failure = json_object_get(root, "error");
    if (!result == !failure) {
        return bad_reply(error, "has neither or both of \"result\" and \"error\"");
    }
    const json_t *id = json_object_get(root, "id");
    if (!id || !rpc_id_read(&m->id, id)) {
        return bad_reply(error, "has no id");
    }
    if (failure) {
        m->kind = SHEAR_MESSAGE_ERROR;
        return read_error(&m->error, failure, error);
    }
    m->kind = SHEAR_MESSAGE_REPLY;
    m->body = json_incref(result);
    return SHEAR_RPC_OK;
}

int shear_message_parse(shear_message *message, const char *line, size_t n,
                        shear_rpc_error *error) {
    *error = (shear_rpc_error){.code = SHEAR_RPC_OK};
    memset(message, 0, sizeof *message);
    message->notice = -1;
    shear_rpc_error why = {0};
    json_t *root = rpc_read_line(line, n, &shear_rpc_reply_limits, NULL, &why);
    if (!root) {
        *error = why;
        return why.code == SHEAR_RPC_OUT_OF_MEMORY
                   ? why.code
                   : shear_rpc_fail(error, SHEAR_RPC_BAD_REPLY, NULL,
                                    "the service's answer cannot be read: %.300s", why.message);
    }
    const char *version = json_string_value(json_object_get(root, "jsonrpc"));
    int rc = SHEAR_RPC_OK;
    if (!version || strcmp(version, "2.0") != 0) {
        rc = bad_reply(error, "is not JSON-RPC 2.0");
    } else if (json_object_get(root, "method")) {
        rc = read_notice(message, root, error);
    } else {
        rc = read_answer(message, root, error);
    }
    json_decref(root);
    if (rc != SHEAR_RPC_OK) {
        shear_message_deinit(message);
    }
    return rc;
}

void shear_message_deinit(shear_message *message) {
    if (message->kind == SHEAR_MESSAGE_NOTICE && message->notice >= 0) {
        msg_deinit(&message->params, rpc_notices[message->notice].params);
    }
    json_decref(message->body);
    memset(message, 0, sizeof *message);
    message->notice = -1;
}

int shear_message_reply(const shear_message *message, int method, shear_reply *reply,
                        shear_rpc_error *error) {
    memset(reply, 0, sizeof *reply);
    if (message->kind != SHEAR_MESSAGE_REPLY || !shear_method_name(method)) {
        return bad_reply(error, "is not a reply");
    }
    const json_t *body = message->body;
    if (!json_is_object(body)) {
        return bad_reply(error, "has a result that is no object");
    }
    return msg_read(reply, rpc_methods[method].reply, body, 0, error);
}

void shear_reply_deinit(shear_reply *reply, int method) {
    if (shear_method_name(method)) {
        msg_deinit(reply, rpc_methods[method].reply);
    }
    memset(reply, 0, sizeof *reply);
}

int shear_message_text(const shear_message *message, char **text, shear_rpc_error *error) {
    *text = rpc_dump(message->body, 0, "", NULL);
    if (*text) {
        return SHEAR_RPC_OK;
    }
    return message->body ? rpc_no_memory(error) : bad_reply(error, "is not a reply");
}

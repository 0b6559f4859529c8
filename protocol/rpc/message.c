/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The client reads what the daemon says. */
#include "rpc/envelope.h"
#include "rpc/methods.h"
#include "json/dump.h"

#include <stdio.h>
#include <string.h>

static int bad_reply(sheard_rpc_error *error, const char *said) {
    return sheard_rpc_fail(error, SHEARD_RPC_BAD_REPLY, NULL, "the service's answer %s", said);
}

static void copy_text(char *buf, size_t size, const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    snprintf(buf, size, "%s", text != NULL ? text : "");
}

static int read_error(sheard_rpc_error *said, const json_t *value, sheard_rpc_error *error) {
    const json_t *number = json_object_get(value, "code");
    const json_t *data = json_object_get(value, "data");
    if (!json_is_object(value) || !json_is_integer(number) ||
        !json_is_string(json_object_get(value, "message")) ||
        (data != NULL && !json_is_object(data))) {
        return bad_reply(error, "has an error without code and message");
    }
    *said = (sheard_rpc_error){.retry = json_is_true(json_object_get(data, "retry"))};
    const json_int_t given = json_integer_value(number);
    said->number = given < INT32_MIN || given > INT32_MAX ? 0 : (int)given;
    copy_text(said->name, sizeof said->name, data, "code");
    copy_text(said->parameter, sizeof said->parameter, data, "parameter");
    copy_text(said->advice, sizeof said->advice, data, "advice");
    copy_text(said->message, sizeof said->message, value, "message");
    said->code = sheard_rpc_code_find(said->name);
    if (said->code == SHEARD_RPC_OK) { /* an error all the same */
        said->code = SHEARD_RPC_UNKNOWN;
    }
    return SHEARD_RPC_OK;
}

static int read_notice(sheard_message *m, const json_t *root, sheard_rpc_error *error) {
    const char *name = json_string_value(json_object_get(root, "method"));
    m->kind = SHEARD_MESSAGE_NOTICE;
    m->notice = -1;
    for (int i = 0; name != NULL && i < SHEARD_N_NOTICES; i++) {
        if (strcmp(rpc_notices[i].name, name) == 0) {
            const int rc = msg_read(&m->params, rpc_notices[i].params,
                                    json_object_get(root, "params"), 0, error);
            m->notice = rc == SHEARD_RPC_OK ? i : -1;
            return rc;
        }
    }
    return name != NULL ? SHEARD_RPC_OK : bad_reply(error, "has a method that is no string");
}

static int read_answer(sheard_message *m, const json_t *root, sheard_rpc_error *error) {
    json_t *result = json_object_get(root, "result");
    json_t *failure = json_object_get(root, "error");
    if ((result == NULL) == (failure == NULL)) {
        return bad_reply(error, "has neither or both of \"result\" and \"error\"");
    }
    const json_t *id = json_object_get(root, "id");
    if (id == NULL || !rpc_id_read(&m->id, id)) {
        return bad_reply(error, "has no id");
    }
    if (failure != NULL) {
        m->kind = SHEARD_MESSAGE_ERROR;
        return read_error(&m->error, failure, error);
    }
    m->kind = SHEARD_MESSAGE_REPLY;
    m->body = json_incref(result);
    return SHEARD_RPC_OK;
}

int sheard_message_parse(sheard_message *message, const char *line, size_t n,
                         sheard_rpc_error *error) {
    *error = (sheard_rpc_error){.code = SHEARD_RPC_OK};
    memset(message, 0, sizeof *message);
    message->notice = -1;
    sheard_rpc_error why = {0};
    json_t *root = rpc_read_line(line, n, &sheard_rpc_reply_limits, NULL, &why);
    if (root == NULL) {
        *error = why;
        return why.code == SHEARD_RPC_OUT_OF_MEMORY
                   ? why.code
                   : sheard_rpc_fail(error, SHEARD_RPC_BAD_REPLY, NULL,
                                     "the service's answer cannot be read: %.300s", why.message);
    }
    const char *version = json_string_value(json_object_get(root, "jsonrpc"));
    int rc = SHEARD_RPC_OK;
    if (version == NULL || strcmp(version, "2.0") != 0) {
        rc = bad_reply(error, "is not JSON-RPC 2.0");
    } else if (json_object_get(root, "method") != NULL) {
        rc = read_notice(message, root, error);
    } else {
        rc = read_answer(message, root, error);
    }
    json_decref(root);
    if (rc != SHEARD_RPC_OK) {
        sheard_message_deinit(message);
    }
    return rc;
}

void sheard_message_deinit(sheard_message *message) {
    if (message->kind == SHEARD_MESSAGE_NOTICE && message->notice >= 0) {
        msg_deinit(&message->params, rpc_notices[message->notice].params);
    }
    json_decref(message->body);
    memset(message, 0, sizeof *message);
    message->notice = -1;
}

int sheard_message_reply(const sheard_message *message, int method, sheard_reply *reply,
                         sheard_rpc_error *error) {
    memset(reply, 0, sizeof *reply);
    if (message->kind != SHEARD_MESSAGE_REPLY || sheard_method_name(method) == NULL) {
        return bad_reply(error, "is not a reply");
    }
    const json_t *body = message->body;
    if (!json_is_object(body)) {
        return bad_reply(error, "has a result that is no object");
    }
    return msg_read(reply, rpc_methods[method].reply, body, 0, error);
}

void sheard_reply_deinit(sheard_reply *reply, int method) {
    if (sheard_method_name(method) != NULL) {
        msg_deinit(reply, rpc_methods[method].reply);
    }
    memset(reply, 0, sizeof *reply);
}

int sheard_message_text(const sheard_message *message, char **text, sheard_rpc_error *error) {
    *text = rpc_dump(message->body, 0, "", NULL);
    if (*text != NULL) {
        return SHEARD_RPC_OK;
    }
    return message->body != NULL ? rpc_no_memory(error) : bad_reply(error, "is not a reply");
}

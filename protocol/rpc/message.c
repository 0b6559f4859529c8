/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parse the daemon's lines, for clients. */
#include "base/text.h"
#include "rpc/envelope.h"
#include "rpc/methods.h"
#include "json/tree.h"

#include <string.h>

static int bad_reply(sheard_rpc_error *error, const char *said) {
    return sheard_rpc_fail(error, SHEARD_RPC_BAD_REPLY, NULL, "the service's answer %s", said);
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
    text_set(said->name, sizeof said->name, json_text_string_at(data, "code"));
    text_set(said->parameter, sizeof said->parameter, json_text_string_at(data, "parameter"));
    text_set(said->advice, sizeof said->advice, json_text_string_at(data, "advice"));
    text_set(said->message, sizeof said->message, json_text_string_at(value, "message"));
    said->code = sheard_rpc_code_find(said->name);
    if (said->code == SHEARD_RPC_OK) { /* the line is an error in any case */
        said->code = SHEARD_RPC_UNKNOWN;
    }
    return SHEARD_RPC_OK;
}

/* Read a notification. One that this version does not have is not an error. */
static int read_notice(sheard_message *m, const json_t *root, sheard_rpc_error *error) {
    const char *name = json_text_string_at(root, "method");
    m->kind = SHEARD_MESSAGE_NOTICE;
    if (name == NULL)
        return bad_reply(error, "has a method that is no string");
    const enum sheard_notice notice = sheard_notice_find(name);
    if (notice == SHEARD_NOTICE_NONE)
        return SHEARD_RPC_OK;
    const int code =
        msg_read(&m->params, rpc_notices[notice].params, json_object_get(root, "params"), 0, error);
    if (code == SHEARD_RPC_OK)
        m->notice = notice;
    return code;
}

static int read_answer(sheard_message *m, const json_t *root, sheard_rpc_error *error) {
    json_t *result = json_object_get(root, "result");
    json_t *failure = json_object_get(root, "error");
    if ((result == NULL) == (failure == NULL))
        return bad_reply(error, "has neither or both of \"result\" and \"error\"");
    const json_t *id = json_object_get(root, "id");
    if (id == NULL || !rpc_id_read(&m->id, id))
        return bad_reply(error, "has no id");
    if (failure != NULL) {
        m->kind = SHEARD_MESSAGE_ERROR;
        return read_error(&m->error, failure, error);
    }
    m->kind = SHEARD_MESSAGE_REPLY;
    m->body = json_incref(result);
    return SHEARD_RPC_OK;
}

static int read_message(sheard_message *m, const json_t *root, sheard_rpc_error *error) {
    if (!rpc_is_2_0(root))
        return bad_reply(error, "is not JSON-RPC 2.0");
    return json_object_get(root, "method") != NULL ? read_notice(m, root, error)
                                                   : read_answer(m, root, error);
}

int sheard_message_parse(sheard_message *message, const char *line, size_t n,
                         sheard_rpc_error *error) {
    *error = (sheard_rpc_error){.code = SHEARD_RPC_OK};
    memset(message, 0, sizeof *message);
    message->notice = SHEARD_NOTICE_NONE;
    sheard_rpc_error why;
    json_auto_t *root = rpc_read_line(line, n, &sheard_rpc_reply_limits, NULL, &why);
    if (root == NULL && why.code == SHEARD_RPC_OUT_OF_MEMORY) {
        *error = why;
        return why.code;
    }
    if (root == NULL) {
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_REPLY, NULL,
                               "the service's answer cannot be read: %.300s", why.message);
    }
    const int code = read_message(message, root, error);
    if (code != SHEARD_RPC_OK)
        sheard_message_deinit(message);
    return code;
}

void sheard_message_deinit(sheard_message *message) {
    if (message->kind == SHEARD_MESSAGE_NOTICE && sheard_notice_name(message->notice) != NULL)
        msg_deinit(&message->params, rpc_notices[message->notice].params);
    json_decref(message->body);
    memset(message, 0, sizeof *message);
    message->notice = SHEARD_NOTICE_NONE;
}

int sheard_message_reply(const sheard_message *message, int method, sheard_reply *reply,
                         sheard_rpc_error *error) {
    memset(reply, 0, sizeof *reply);
    if (message->kind != SHEARD_MESSAGE_REPLY || sheard_method_name(method) == NULL)
        return bad_reply(error, "is not a reply");
    const json_t *body = message->body;
    if (!json_is_object(body))
        return bad_reply(error, "has a result that is no object");
    return msg_read(reply, rpc_methods[method].reply, body, 0, error);
}

void sheard_reply_deinit(sheard_reply *reply, int method) {
    if (sheard_method_name(method) != NULL)
        msg_deinit(reply, rpc_methods[method].reply);
    memset(reply, 0, sizeof *reply);
}

int sheard_message_text(const sheard_message *message, char **text, sheard_rpc_error *error) {
    if (message->body == NULL) {
        *text = NULL;
        return bad_reply(error, "is not a reply");
    }
    return rpc_write_text(text, NULL, json_incref(message->body), 0, "", error);
}

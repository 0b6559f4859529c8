/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rpc/envelope.h"

#include "rpc/scan.h"
#include "json/dump.h"
#include "json/load.h"
#include "json/text.h"

#include <stdarg.h>
#include <string.h>

int rpc_no_memory(sheard_rpc_error *error) {
    return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory");
}

bool sheard_rpc_id_equal(const sheard_rpc_id *a, const sheard_rpc_id *b) {
    return a->type == b->type && (a->type != SHEARD_ID_INTEGER || a->integer == b->integer) &&
           (a->type != SHEARD_ID_TEXT || strcmp(a->text, b->text) == 0);
}

bool rpc_id_read(sheard_rpc_id *id, const json_t *value) {
    *id = (sheard_rpc_id){.type = SHEARD_ID_NULL};
    if (json_is_integer(value)) {
        id->type = SHEARD_ID_INTEGER;
        id->integer = json_integer_value(value);
        return true;
    }
    if (!json_is_string(value)) {
        return json_is_null(value);
    }
    const size_t n = json_string_length(value);
    if (n > SHEARD_RPC_ID_MAX || strlen(json_string_value(value)) != n) {
        return false;
    }
    id->type = SHEARD_ID_TEXT;
    memcpy(id->text, json_string_value(value), n + 1);
    return true;
}

json_t *rpc_id_write(const sheard_rpc_id *id) {
    return id->type == SHEARD_ID_INTEGER ? json_integer(id->integer)
           : id->type == SHEARD_ID_TEXT  ? json_text_string(id->text)
                                         : json_null();
}

/* From a line that is not taken as a whole: the value of the one "id" of its outermost object. */
static void recover_id(sheard_rpc_id *id, const char *line, const rpc_scan *scan) {
    if (scan->n_ids != 1 || scan->id_end <= scan->id_at) {
        return;
    }
    rpc_load_error why;
    json_t *value = rpc_load(line + scan->id_at, scan->id_end - scan->id_at, JSON_DECODE_ANY, &why);
    (void)rpc_id_read(id, value);
    json_decref(value);
}

json_t *rpc_read_line(const char *line, size_t n, const sheard_rpc_limits *limits,
                      sheard_rpc_id *id, sheard_rpc_error *error) {
    rpc_scan scan;
    json_t *root = NULL;
    int rc = rpc_scan_line(&scan, line, n, limits, error);
    if (rc == SHEARD_RPC_OK) {
        rpc_load_error why;
        root = rpc_load(line, n, JSON_DECODE_ANY, &why);
        rc = root != NULL ? SHEARD_RPC_OK : sheard_rpc_fail(error, why.code, NULL, "%s", why.text);
    }
    if (id != NULL) {
        *id = (sheard_rpc_id){.type = SHEARD_ID_NULL};
    }
    if (id != NULL && (rc == SHEARD_RPC_TOO_COMPLEX || rc == SHEARD_RPC_DUPLICATE_KEY)) {
        recover_id(id, line, &scan);
    }
    return root;
}

int rpc_write_line(char **line, size_t *n, sheard_rpc_error *error, ...) {
    *line = NULL;
    *n = 0;
    json_t *object = json_object();
    bool failed = object == NULL;
    json_text_set(object, "jsonrpc", json_string("2.0"), &failed);
    va_list members;
    va_start(members, error);
    for (const char *name = va_arg(members, const char *); name;
         name = va_arg(members, const char *)) {
        json_text_set(object, name, va_arg(members, json_t *), &failed);
    }
    va_end(members);
    object = json_text_whole(object, failed);
    *line = rpc_dump(object, 0, "\n", n);
    json_decref(object);
    return *line != NULL ? SHEARD_RPC_OK : rpc_no_memory(error);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rpc/envelope.h"

#include "rpc/scan.h"
#include "json/tree.h"

#include <string.h>

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
    if (!json_is_string(value))
        return json_is_null(value);
    const size_t n = json_string_length(value);
    if (n > SHEARD_RPC_ID_MAX || strlen(json_string_value(value)) != n)
        return false;
    id->type = SHEARD_ID_TEXT;
    memcpy(id->text, json_string_value(value), n + 1);
    return true;
}

json_t *rpc_id_write(const sheard_rpc_id *id) {
    return id->type == SHEARD_ID_INTEGER ? json_integer(id->integer)
           : id->type == SHEARD_ID_TEXT  ? json_text_string(id->text)
                                         : json_null();
}

bool rpc_is_2_0(const json_t *root) {
    const char *version = json_text_string_at(root, "jsonrpc");
    return version != NULL && strcmp(version, "2.0") == 0;
}

/* Recover the id from a line that cannot be parsed: the value of the only "id" of its outermost
 * object. */
static void recover_id(sheard_rpc_id *id, const char *line, const rpc_scan *scan) {
    if (scan->n_ids != 1 || scan->id_end <= scan->id_at)
        return;
    tree_error why;
    json_auto_t *value =
        tree_load(line + scan->id_at, scan->id_end - scan->id_at, JSON_DECODE_ANY, &why);
    (void)rpc_id_read(id, value);
}

static json_t *load(const char *line, size_t n, sheard_rpc_error *error) {
    static const int codes[] = {[TREE_NO_MEMORY] = SHEARD_RPC_OUT_OF_MEMORY,
                                [TREE_SYNTAX] = SHEARD_RPC_PARSE_ERROR,
                                [TREE_DUPLICATE_KEY] = SHEARD_RPC_DUPLICATE_KEY};
    tree_error why;
    json_t *root = tree_load(line, n, JSON_DECODE_ANY, &why);
    if (root == NULL)
        sheard_rpc_fail(error, codes[why.fault], NULL, "%s", why.text);
    return root;
}

json_t *rpc_read_line(const char *line, size_t n, const sheard_rpc_limits *limits,
                      sheard_rpc_id *id, sheard_rpc_error *error) {
    rpc_scan scan;
    *error = (sheard_rpc_error){.code = SHEARD_RPC_OK};
    json_t *root =
        rpc_scan_line(&scan, line, n, limits, error) == SHEARD_RPC_OK ? load(line, n, error) : NULL;
    if (id != NULL)
        *id = (sheard_rpc_id){.type = SHEARD_ID_NULL};
    if (id != NULL &&
        (error->code == SHEARD_RPC_TOO_COMPLEX || error->code == SHEARD_RPC_DUPLICATE_KEY)) {
        recover_id(id, line, &scan);
    }
    return root;
}

json_t *rpc_read_object(const char *text, size_t n, const sheard_rpc_limits *limits,
                        const char *what, sheard_rpc_error *error) {
    json_t *root = rpc_read_line(text, n, limits, NULL, error);
    if (root != NULL && !json_is_object(root)) {
        sheard_rpc_fail(error, SHEARD_RPC_BAD_PARAMETER, NULL, "%s must be one object", what);
        json_decref(root);
        return NULL;
    }
    return root;
}

int rpc_write_text(char **text, size_t *n, json_t *value, size_t flags, const char *tail,
                   sheard_rpc_error *error) {
    *text = NULL;
    if (n != NULL)
        *n = 0;
    if (value == NULL)
        return error->code;
    *text = tree_dump(value, flags, tail, n);
    json_decref(value);
    return *text != NULL ? SHEARD_RPC_OK
                         : sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory");
}

int rpc_write_line(char **line, size_t *n, json_t *object, sheard_rpc_error *error) {
    if (object == NULL) {
        *line = NULL;
        *n = 0;
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory");
    }
    return rpc_write_text(line, n, object, 0, "\n", error);
}

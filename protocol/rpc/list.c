/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replies whose list is made item by item. */
#include "rpc/envelope.h"
#include "rpc/methods.h"
#include "json/dump.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The list of a method's reply; NULL: it has none. */
static const msg_member *list_of(int method) {
    const msg_table *table =
        sheard_method_name(method) != NULL ? rpc_methods[method].reply : &msg_nothing;
    for (size_t i = 0; i < table->n; i++) {
        if (table->members[i].type == MSG_OBJECTS) {
            return &table->members[i];
        }
    }
    return NULL;
}

static int no_list(sheard_rpc_error *error, int method) {
    return sheard_rpc_fail(error, SHEARD_RPC_INTERNAL, NULL, "replies of method %d have no list",
                           method);
}

int sheard_reply_item(char **text, size_t *n, int method, const void *item,
                      sheard_rpc_error *error) {
    const msg_member *list = list_of(method);
    *text = NULL;
    *n = 0;
    if (list == NULL) {
        return no_list(error, method);
    }
    json_t *object = msg_write(item, list->table, 0, error);
    if (object == NULL) {
        return error->code;
    }
    *text = rpc_dump(object, 0, "", n);
    json_decref(object);
    return *text != NULL ? SHEARD_RPC_OK : rpc_no_memory(error);
}

/* The items go into the brackets of the empty list. These bytes stand nowhere else before it: in a
 * string, quotes are written with a backslash. */
static int splice(char **line, size_t *n, const char *member, const char *items, size_t n_items,
                  sheard_rpc_error *error) {
    char empty[80];
    const int length = snprintf(empty, sizeof empty, "\"%s\":[]", member);
    const char *at = strstr(*line, empty);
    char *whole = at != NULL ? malloc(*n + n_items + 1) : NULL;
    if (whole != NULL) {
        const size_t head = (size_t)(at - *line) + (size_t)length - 1;
        memcpy(whole, *line, head);
        memcpy(whole + head, items, n_items);
        memcpy(whole + head + n_items, *line + head, *n - head + 1);
        *n += n_items;
    }
    free(*line);
    *line = whole;
    *n = whole != NULL ? *n : 0;
    return whole != NULL ? SHEARD_RPC_OK : rpc_no_memory(error);
}

int sheard_reply_list_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                           const sheard_reply *rest, const char *items, size_t n_items,
                           sheard_rpc_error *error) {
    const msg_member *list = list_of(method);
    *line = NULL;
    *n = 0;
    if (list == NULL) {
        return no_list(error, method);
    }
    const int rc = sheard_reply_line(line, n, id, method, rest, error);
    return rc == SHEARD_RPC_OK && n_items > 0 ? splice(line, n, list->name, items, n_items, error)
                                              : rc;
}

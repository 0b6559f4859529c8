/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write replies whose list is written item by item. */
#include "rpc/envelope.h"
#include "rpc/methods.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Return the list of a method's reply, or NULL with *error set if it has none. */
static const msg_member *list_of(int method, sheard_rpc_error *error) {
    const msg_table *table =
        sheard_method_name(method) != NULL ? rpc_methods[method].reply : &msg_nothing;
    for (size_t i = 0; i < table->n; i++) {
        if (table->members[i].type == MSG_OBJECTS)
            return &table->members[i];
    }
    sheard_rpc_fail(error, SHEARD_RPC_INTERNAL, NULL, "replies of method %d have no list", method);
    return NULL;
}

int sheard_reply_item(char **text, size_t *n, int method, const void *item,
                      sheard_rpc_error *error) {
    const msg_member *list = list_of(method, error);
    json_t *object = list != NULL ? msg_write(item, list->table, 0, error) : NULL;
    return rpc_write_text(text, n, object, 0, "", error);
}

/* Insert the items between the brackets of the empty list. Its bytes do not occur before it: within
 * a string, quotes are escaped. */
static int splice(char **line, size_t *n, const char *member, const char *items, size_t n_items,
                  sheard_rpc_error *error) {
    char empty[80];
    const int length = snprintf(empty, sizeof empty, "\"%s\":[]", member);
    const char *at = strstr(*line, empty);
    assert(at != NULL); /* the list of `rest` is empty */
    char *whole = malloc(*n + n_items + 1);
    if (whole != NULL) {
        const size_t head = (size_t)(at - *line) + (size_t)length - 1;
        memcpy(whole, *line, head);
        memcpy(whole + head, items, n_items);
        memcpy(whole + head + n_items, *line + head, *n - head + 1);
    }
    free(*line);
    *line = whole;
    *n = whole != NULL ? *n + n_items : 0;
    return whole != NULL ? SHEARD_RPC_OK
                         : sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory");
}

int sheard_reply_list_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                           const sheard_reply *rest, const char *items, size_t n_items,
                           sheard_rpc_error *error) {
    const msg_member *list = list_of(method, error);
    if (list == NULL) {
        *line = NULL;
        *n = 0;
        return error->code;
    }
    const int code = sheard_reply_line(line, n, id, method, rest, error);
    return code == SHEARD_RPC_OK && n_items > 0 ? splice(line, n, list->name, items, n_items, error)
                                                : code;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read messages from JSON: objects and lists. */
#include "base/cleanup.h"
#include "base/text.h"
#include "message/reader.h"
#include "json/tree.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const msg_member *find_member(const msg_table *table, const char *name) {
    for (size_t i = 0; i < table->n; i++) {
        if (strcmp(table->members[i].name, name) == 0)
            return &table->members[i];
    }
    return NULL;
}

static int refuse_unknown(msg_reader *r, const msg_table *table, const char *name) {
    char known[300] = "";
    reader_enter(r, name);
    if (table->n == 0)
        return reader_fail(r, SHEARD_RPC_UNKNOWN_PARAMETER, "there are no parameters here");
    for (size_t i = 0; i < table->n; i++)
        text_append_item(known, sizeof known, table->members[i].name);
    return reader_fail(r, SHEARD_RPC_UNKNOWN_PARAMETER, "no such parameter; there are: %s", known);
}

static int check_names(msg_reader *r, const msg_table *table, const json_t *object) {
    /* jansson's iterators are not const; nothing is changed. */
    json_t *o = (json_t *)object;
    for (void *i = json_object_iter(o); i != NULL; i = json_object_iter_next(o, i)) {
        const char *name = json_object_iter_key(i);
        if (find_member(table, name) == NULL)
            return refuse_unknown(r, table, name);
    }
    return SHEARD_RPC_OK;
}

static int copy_object(const msg_reader *r, const char **at, const json_t *object) {
    *at = tree_dump(object, 0, "", NULL);
    return *at != NULL ? SHEARD_RPC_OK : reader_no_memory(r);
}

/* Read the members that the table does not name. (json_copy ignores lack of memory.) */
static int read_merged(const msg_reader *r, const char **at, const msg_table *table,
                       const json_t *object) {
    json_t *o = (json_t *)object;
    json_auto_t *rest = json_object();
    bool failed = rest == NULL;
    for (void *i = json_object_iter(o); i != NULL && !failed; i = json_object_iter_next(o, i)) {
        const char *name = json_object_iter_key(i);
        failed = find_member(table, name) == NULL &&
                 json_object_set(rest, name, json_object_iter_value(i)) != 0;
    }
    return failed ? reader_no_memory(r) : copy_object(r, at, rest);
}

static int read_states(msg_reader *r, unsigned *set, const msg_member *m, const json_t *value) {
    unsigned found = 0;
    for (size_t i = 0; i < json_array_size(value); i++) {
        const json_t *item = json_array_get(value, i);
        const int index = reader_name_index(m->names, item);
        const size_t mark = reader_enter_item(r, i);
        if (index < 0)
            return reader_wrong_name(r, m->names, item);
        found |= 1u << index;
        reader_leave(r, mark);
    }
    *set = found;
    return SHEARD_RPC_OK;
}

/* NOLINTBEGIN(misc-no-recursion): as deep as the tables are nested */

static int read_object(msg_reader *r, void *message, const msg_table *table, const json_t *object);

static int read_item(msg_reader *r, void *at, const msg_member *m, const json_t *value) {
    static const msg_member number = {.type = MSG_INT, .min = 1, .max = INT64_MAX};
    switch (m->type) {
    case MSG_INTS:
        return reader_scalar(r, at, &number, value);
    case MSG_TEXTS:
        return reader_string(r, at, m->flags, m->item_max, value);
    default:
        msg_init(at, m->table);
        return read_object(r, at, m->table, value);
    }
}

/* Read a list. At any time the list and its length are such that msg_deinit can free them. */
static int read_items(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    const size_t n = json_array_size(value);
    const size_t size = msg_item_size(m);
    char *list = n > 0 ? calloc(n, size) : NULL;
    if (n > 0 && list == NULL)
        return reader_no_memory(r);
    msg_put_pointer(message, m->offset, list);
    msg_put_count(message, m, n);
    for (size_t i = 0; i < n; i++) {
        const size_t mark = reader_enter_item(r, i);
        TRY(read_item(r, list + i * size, m, json_array_get(value, i)));
        reader_leave(r, mark);
    }
    return SHEARD_RPC_OK;
}

static int read_list(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    if (!json_is_array(value))
        return reader_wrong_type(r, "an array", value);
    const size_t n = json_array_size(value);
    if (reader_is_strict(r) && m->max > 0 && n > (size_t)m->max) {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER,
                           "expected at most %" PRId64 " elements, not %zu", m->max, n);
    }
    if (reader_is_strict(r) && (m->flags & MSG_REQUIRED) != 0 && n == 0)
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected at least one element");
    return m->type == MSG_STATES ? read_states(r, (void *)((char *)message + m->offset), m, value)
                                 : read_items(r, message, m, value);
}

static int read_value(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    void *at = (char *)message + m->offset;
    switch (m->type) {
    case MSG_TEXT:
        return reader_string(r, at, m->flags, m->max, value);
    case MSG_RAW:
        return json_is_object(value) ? copy_object(r, at, value)
                                     : reader_wrong_type(r, "an object", value);
    case MSG_SETTINGS:
        return reader_settings(r, at, value);
    case MSG_INTS:
    case MSG_TEXTS:
    case MSG_OBJECTS:
    case MSG_STATES:
        return read_list(r, message, m, value);
    case MSG_OBJECT:
        return read_object(r, at, m->table, value);
    default:
        return reader_scalar(r, at, m, value);
    }
}

/* Read a member. null means absent. */
static int read_member(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    const size_t mark = reader_enter(r, m->name);
    int code = SHEARD_RPC_OK;
    if (value != NULL && !json_is_null(value)) {
        code = read_value(r, message, m, value);
    } else if ((m->flags & MSG_REQUIRED) != 0) {
        code = value != NULL ? reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "must not be null")
                             : reader_fail(r, SHEARD_RPC_MISSING_PARAMETER, "is missing");
    }
    reader_leave(r, mark);
    return code;
}

static int read_object(msg_reader *r, void *message, const msg_table *table, const json_t *object) {
    if (object != NULL && !json_is_object(object))
        return reader_wrong_type(r, "an object", object);
    if (reader_is_strict(r) && object != NULL)
        TRY(check_names(r, table, object));
    for (size_t i = 0; i < table->n; i++) {
        const msg_member *m = &table->members[i];
        TRY(m->type == MSG_MERGED
                ? read_merged(r, (void *)((char *)message + m->offset), table, object)
                : read_member(r, message, m, json_object_get(object, m->name)));
    }
    return SHEARD_RPC_OK;
}

/* NOLINTEND(misc-no-recursion) */

int msg_read(void *message, const msg_table *table, const json_t *object, unsigned mode,
             sheard_rpc_error *error) {
    msg_reader r = {.mode = mode, .error = error};
    assert((mode & MSG_SPARSE) == 0);
    msg_init(message, table);
    int code = read_object(&r, message, table, object);
    if (code == SHEARD_RPC_OK && reader_is_strict(&r) && table->check != NULL)
        code = table->check(message, error);
    if (code != SHEARD_RPC_OK)
        msg_deinit(message, table);
    return code;
}

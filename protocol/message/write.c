/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write messages as JSON. */
#include "message/reader.h"
#include "json/text.h"
#include "json/tree.h"

#include <assert.h>
#include <string.h>

typedef struct writer {
    unsigned mode;           /* set of enum msg_mode */
    sheard_rpc_error *error; /* set at the first failure */
    bool failed;
} writer;

/* Return NULL, and record the reason unless there is one already. */
static json_t *fail(writer *w, int code, const char *member) {
    if (w->failed)
        return NULL;
    w->failed = true;
    if (code == SHEARD_RPC_OUT_OF_MEMORY) {
        sheard_rpc_fail(w->error, code, NULL, "out of memory while writing");
    } else {
        sheard_rpc_fail_parameter(w->error, code, member, NULL, "%s",
                                  code == SHEARD_RPC_INTERNAL ? "is not well-formed"
                                                              : "is not UTF-8");
    }
    return NULL;
}

static json_t *made(writer *w, json_t *value) {
    return value != NULL ? value : fail(w, SHEARD_RPC_OUT_OF_MEMORY, "");
}

/* Write a text. In a request it must be UTF-8: a path with a byte replaced would be another path.
 */
static json_t *write_text(writer *w, const char *member, const char *text) {
    json_t *value = made(w, json_text_string(text));
    if (value != NULL && text != NULL && (w->mode & MSG_SPARSE) != 0 &&
        strcmp(json_string_value(value), text) != 0) {
        json_decref(value);
        return fail(w, SHEARD_RPC_BAD_PARAMETER, member);
    }
    return value;
}

static json_t *write_raw(writer *w, const char *member, const char *text) {
    if (text == NULL)
        return json_null();
    tree_error why;
    json_t *value = tree_load(text, strlen(text), 0, &why);
    if (value == NULL) {
        return fail(w, why.fault == TREE_NO_MEMORY ? SHEARD_RPC_OUT_OF_MEMORY : SHEARD_RPC_INTERNAL,
                    member);
    }
    if (!json_is_object(value)) {
        json_decref(value);
        return fail(w, SHEARD_RPC_INTERNAL, member);
    }
    return value;
}

static json_t *write_settings(writer *w, const char *member, const char *text) {
    bool bad = false;
    json_t *value = text != NULL ? msg_write_settings(text, &bad) : json_null();
    if (bad) {
        return fail(w, (w->mode & MSG_SPARSE) != 0 ? SHEARD_RPC_BAD_SETTING : SHEARD_RPC_INTERNAL,
                    member);
    }
    return made(w, value);
}

static json_t *write_states(writer *w, unsigned set, const msg_member *m) {
    json_t *array = json_array();
    for (int i = 0; m->names[i] != NULL; i++) {
        if ((set & 1u << i) != 0)
            json_text_append(&array, json_string(m->names[i]));
    }
    return made(w, array);
}

static json_t *write_integer(writer *w, int64_t value, const msg_member *m) {
    const bool is_null = (m->flags & MSG_NULLABLE) != 0 && value == m->fallback;
    return is_null ? json_null() : made(w, json_integer(value));
}

static json_t *write_name(writer *w, int index, const msg_member *m) {
    const char *name = msg_name(m->names, index);
    return made(w, name[0] == '\0' ? json_null() : json_string(name));
}

static json_t *write_time(writer *w, int64_t ms) {
    char text[SHEARD_TIME_SIZE];
    return ms == 0 ? json_null() : made(w, json_string(sheard_time_format(ms, text)));
}

/* NOLINTBEGIN(misc-no-recursion): as deep as the tables are nested */

static json_t *write_object(writer *w, const void *message, const msg_table *table);

static json_t *write_item(writer *w, const void *at, const msg_member *m) {
    switch (m->type) {
    case MSG_INTS:
        return made(w, json_integer(*(const int64_t *)at));
    case MSG_TEXTS:
        return write_text(w, m->name, msg_pointer(at, 0));
    default:
        return write_object(w, at, m->table);
    }
}

static json_t *write_list(writer *w, const void *message, const msg_member *m) {
    const char *list = msg_pointer(message, m->offset);
    const size_t n = msg_count(message, m);
    json_t *array = json_array();
    assert(list != NULL || n == 0);
    for (size_t i = 0; array != NULL && i < n; i++)
        json_text_append(&array, write_item(w, list + i * msg_item_size(m), m));
    return made(w, array);
}

static json_t *write_value(writer *w, const void *message, const msg_member *m) {
    const void *at = (const char *)message + m->offset;
    switch (m->type) {
    case MSG_BOOL:
        return json_boolean(*(const bool *)at);
    case MSG_INT:
        return write_integer(w, *(const int64_t *)at, m);
    case MSG_REAL:
        return made(w, json_text_number(*(const double *)at));
    case MSG_NAME:
        return write_name(w, *(const int *)at, m);
    case MSG_TIME:
        return write_time(w, *(const int64_t *)at);
    case MSG_TEXT:
        return write_text(w, m->name, msg_pointer(at, 0));
    case MSG_RAW:
        return write_raw(w, m->name, msg_pointer(at, 0));
    case MSG_SETTINGS:
        return write_settings(w, m->name, msg_pointer(at, 0));
    case MSG_STATES:
        return write_states(w, *(const unsigned *)at, m);
    case MSG_OBJECT:
        return msg_is_absent(message, m) ? json_null() : write_object(w, at, m->table);
    default:
        return write_list(w, message, m);
    }
}

static json_t *begin(writer *w, const void *message, const msg_table *table) {
    const msg_member *first = table->members;
    const char *merged =
        table->n > 0 && first->type == MSG_MERGED ? msg_pointer(message, first->offset) : NULL;
    return merged != NULL ? write_raw(w, "report", merged) : made(w, json_object());
}

static json_t *write_object(writer *w, const void *message, const msg_table *table) {
    json_t *object = begin(w, message, table);
    for (size_t i = 0; object != NULL && i < table->n; i++) {
        const msg_member *m = &table->members[i];
        if (m->type == MSG_MERGED || ((w->mode & MSG_SPARSE) != 0 && msg_is_absent(message, m)))
            continue;
        if (json_object_set_new(object, m->name, write_value(w, message, m)) != 0) {
            json_decref(object);
            return fail(w, SHEARD_RPC_OUT_OF_MEMORY, "");
        }
    }
    return object;
}

/* NOLINTEND(misc-no-recursion) */

json_t *msg_write(const void *message, const msg_table *table, unsigned mode,
                  sheard_rpc_error *error) {
    writer w = {.mode = mode, .error = error};
    assert((mode & MSG_STRICT) == 0);
    return write_object(&w, message, table);
}

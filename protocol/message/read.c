/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From JSON to messages: objects. */
#include "message/table.h"
#include "json/dump.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t msg_enter(msg_reader *r, const char *member) {
    const size_t mark = strlen(r->path);
    snprintf(r->path + mark, sizeof r->path - mark, "%s%.60s", mark > 0 ? "." : "", member);
    return mark;
}

size_t msg_enter_item(msg_reader *r, size_t index) {
    const size_t mark = strlen(r->path);
    snprintf(r->path + mark, sizeof r->path - mark, "[%zu]", index);
    return mark;
}

void msg_leave(msg_reader *r, size_t mark) {
    r->path[mark] = '\0';
}

int msg_fail(msg_reader *r, int code, const char *format, ...) {
    char said[400];
    va_list args;
    va_start(args, format);
    vsnprintf(said, sizeof said, format, args);
    va_end(args);
    if (!(r->mode & MSG_STRICT)) {
        code = SHEARD_RPC_BAD_REPLY;
    }
    sheard_rpc_fail(r->error, code, NULL, "'%.*s': %s", (int)sizeof r->path - 1, r->path, said);
    snprintf(r->error->parameter, sizeof r->error->parameter, "%s", r->path);
    return code;
}

int msg_no_memory(msg_reader *r) {
    return sheard_rpc_fail(r->error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory while reading");
}

const char *msg_kind(const json_t *value) {
    static const char *const kinds[] = {
        [JSON_OBJECT] = "an object", [JSON_ARRAY] = "an array", [JSON_STRING] = "a string",
        [JSON_INTEGER] = "a number", [JSON_REAL] = "a number",  [JSON_TRUE] = "true",
        [JSON_FALSE] = "false",      [JSON_NULL] = "null",
    };
    return value != NULL ? kinds[json_typeof(value)] : "nothing";
}

static const msg_member *find_member(const msg_table *table, const char *name) {
    for (size_t i = 0; i < table->n; i++) {
        if (strcmp(table->members[i].name, name) == 0) {
            return &table->members[i];
        }
    }
    return NULL;
}

static int refuse_unknown(msg_reader *r, const msg_table *table, const char *name) {
    char known[300] = "";
    for (size_t i = 0; i < table->n; i++) {
        const size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i > 0 ? ", " : "",
                 table->members[i].name);
    }
    msg_enter(r, name);
    if (table->n == 0) {
        return msg_fail(r, SHEARD_RPC_UNKNOWN_PARAMETER, "there are no parameters here");
    }
    return msg_fail(r, SHEARD_RPC_UNKNOWN_PARAMETER, "no such parameter; there are: %s", known);
}

static int check_names(msg_reader *r, const msg_table *table, const json_t *object) {
    /* jansson's iterators take no const; nothing is changed. */
    json_t *o = (json_t *)object;
    for (void *i = json_object_iter(o); i; i = json_object_iter_next(o, i)) {
        const char *name = json_object_iter_key(i);
        if (find_member(table, name) == NULL) {
            return refuse_unknown(r, table, name);
        }
    }
    return SHEARD_RPC_OK;
}

/* What an object has beside the members that the table names. (json_copy passes over want of
 * memory.)
 */
static int read_merged(msg_reader *r, const char **at, const msg_table *table,
                       const json_t *object) {
    json_t *o = (json_t *)object;
    json_t *rest = json_object();
    bool failed = rest == NULL;
    for (void *i = json_object_iter(o); i != NULL && !failed; i = json_object_iter_next(o, i)) {
        const char *name = json_object_iter_key(i);
        failed = find_member(table, name) == NULL &&
                 json_object_set(rest, name, json_object_iter_value(i)) != 0;
    }
    *at = failed ? NULL : rpc_dump(rest, 0, "", NULL);
    json_decref(rest);
    return *at != NULL ? SHEARD_RPC_OK : msg_no_memory(r);
}

static int read_raw(msg_reader *r, const char **at, const json_t *value) {
    if (!json_is_object(value)) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected an object, not %s", msg_kind(value));
    }
    *at = rpc_dump(value, 0, "", NULL);
    return *at != NULL ? SHEARD_RPC_OK : msg_no_memory(r);
}

/* NOLINTBEGIN(misc-no-recursion): as deep as the tables are in each other */

static int read_value(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    void *at = (char *)message + m->offset;
    switch (m->type) {
    case MSG_TEXT:
        return msg_read_text(r, at, m, value);
    case MSG_RAW:
        return read_raw(r, at, value);
    case MSG_SETTINGS:
        return msg_read_settings(r, at, value);
    case MSG_INTS:
    case MSG_TEXTS:
    case MSG_OBJECTS:
    case MSG_STATES:
        return msg_read_list(r, message, m, value);
    case MSG_OBJECT:
        return msg_read_object(r, at, m->table, value);
    default:
        return msg_read_number(r, at, m, value);
    }
}

/* null is as good as absent. */
static int read_member(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    const size_t mark = msg_enter(r, m->name);
    int rc = SHEARD_RPC_OK;
    if (value != NULL && !json_is_null(value)) {
        rc = read_value(r, message, m, value);
    } else if (m->flags & MSG_REQUIRED) {
        rc = value != NULL ? msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "must not be null")
                           : msg_fail(r, SHEARD_RPC_MISSING_PARAMETER, "is missing");
    }
    msg_leave(r, mark);
    return rc;
}

int msg_read_object(msg_reader *r, void *message, const msg_table *table, const json_t *object) {
    if (object != NULL && !json_is_object(object)) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected an object, not %s",
                        msg_kind(object));
    }
    int rc = r->mode & MSG_STRICT && object != NULL ? check_names(r, table, object) : SHEARD_RPC_OK;
    for (size_t i = 0; rc == SHEARD_RPC_OK && i < table->n; i++) {
        const msg_member *m = &table->members[i];
        rc = m->type == MSG_MERGED
                 ? read_merged(r, (void *)((char *)message + m->offset), table, object)
                 : read_member(r, message, m, json_object_get(object, m->name));
    }
    return rc;
}

/* NOLINTEND(misc-no-recursion) */

int msg_read(void *message, const msg_table *table, const json_t *object, unsigned mode,
             sheard_rpc_error *error) {
    msg_reader r = {.mode = mode, .error = error};
    msg_init(message, table);
    int rc = msg_read_object(&r, message, table, object);
    if (rc == SHEARD_RPC_OK && mode & MSG_STRICT && table->check != NULL) {
        rc = table->check(message, error);
    }
    if (rc != SHEARD_RPC_OK) {
        msg_deinit(message, table);
    }
    return rc;
}

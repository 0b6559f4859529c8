/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From JSON to messages: numbers, names, texts and lists. */
#include "message/table.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static bool strict(const msg_reader *r) {
    return r->mode & MSG_STRICT;
}

static int wrong_type(msg_reader *r, const char *expected, const json_t *value) {
    return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected %s, not %s", expected, msg_kind(value));
}

static int read_integer(msg_reader *r, int64_t *at, const msg_member *m, const json_t *value) {
    if (!json_is_integer(value)) {
        return wrong_type(r, "a whole number", value);
    }
    const int64_t given = json_integer_value(value);
    if (strict(r) && (given < m->min || given > m->max)) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER,
                        "expected a whole number from %" PRId64 " to %" PRId64 ", not %" PRId64,
                        m->min, m->max, given);
    }
    *at = given;
    return SHEARD_RPC_OK;
}

static int read_real(msg_reader *r, double *at, const msg_member *m, const json_t *value) {
    if (!json_is_number(value)) {
        return wrong_type(r, "a number", value);
    }
    const double given = json_number_value(value);
    if (strict(r) && !(given >= (double)m->min && given <= (double)m->max)) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER,
                        "expected a number from %" PRId64 " to %" PRId64 ", not %g", m->min, m->max,
                        given);
    }
    *at = given;
    return SHEARD_RPC_OK;
}

/* The index of a name, or -1. A text with a NUL in it equals no name. */
static int name_index(const char *const *names, const json_t *value) {
    const char *text = json_string_value(value);
    for (int i = 0; text != NULL && names[i] != NULL; i++) {
        if (names[i][0] != '\0' && strlen(text) == json_string_length(value) &&
            strcmp(names[i], text) == 0) {
            return i;
        }
    }
    return -1;
}

static int wrong_name(msg_reader *r, const char *const *names, const json_t *value) {
    char known[200] = "";
    for (int i = 0; names[i]; i++) {
        const size_t used = strlen(known);
        if (names[i][0] != '\0') {
            snprintf(known + used, sizeof known - used, "%s%s", used > 0 ? ", " : "", names[i]);
        }
    }
    if (!json_is_string(value)) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected one of %s, not %s", known,
                        msg_kind(value));
    }
    return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected one of %s, not \"%.60s\"", known,
                    json_string_value(value));
}

/* What a newer service may say is -1, "unknown"; what a client says must be known. */
static int read_name(msg_reader *r, int *at, const msg_member *m, const json_t *value) {
    *at = name_index(m->names, value);
    if (*at < 0 && (strict(r) || !json_is_string(value))) {
        return wrong_name(r, m->names, value);
    }
    return SHEARD_RPC_OK;
}

static int read_time(msg_reader *r, int64_t *at, const json_t *value) {
    if (!json_is_string(value) || !sheard_time_parse(at, json_string_value(value))) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER,
                        "expected a time such as \"2026-01-31T12:00:00Z\"");
    }
    return SHEARD_RPC_OK;
}

int msg_read_number(msg_reader *r, void *at, const msg_member *m, const json_t *value) {
    switch (m->type) {
    case MSG_BOOL:
        if (!json_is_boolean(value)) {
            return wrong_type(r, "true or false", value);
        }
        *(bool *)at = json_is_true(value);
        return SHEARD_RPC_OK;
    case MSG_INT:
        return read_integer(r, at, m, value);
    case MSG_REAL:
        return read_real(r, at, m, value);
    case MSG_NAME:
        return read_name(r, at, m, value);
    default:
        return read_time(r, at, value);
    }
}

static bool has_control(const char *text) {
    for (; *text != '\0'; text++) {
        if ((unsigned char)*text < 0x20 || *text == 0x7F) {
            return true;
        }
    }
    return false;
}

static int check_text(msg_reader *r, const char *text, size_t n, unsigned flags, int64_t longest) {
    if (strlen(text) != n) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "has a NUL character in it");
    }
    if (!strict(r)) {
        return SHEARD_RPC_OK;
    }
    if (longest > 0 && n > (size_t)longest) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected at most %" PRId64 " bytes, not %zu",
                        longest, n);
    }
    if (flags & MSG_PLAIN && (n == 0 || has_control(text))) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER,
                        n == 0 ? "must not be empty" : "has a control character in it");
    }
    if (flags & MSG_ABSOLUTE && text[0] != '/') {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER,
                        "expected a path from the root (\"/data/...\"), not \"%.80s\"", text);
    }
    return SHEARD_RPC_OK;
}

static int read_string(msg_reader *r, const char **at, unsigned flags, int64_t longest,
                       const json_t *value) {
    if (!json_is_string(value)) {
        return wrong_type(r, "a string", value);
    }
    const char *text = json_string_value(value);
    const size_t n = json_string_length(value);
    const int rc = check_text(r, text, n, flags, longest);
    if (rc != SHEARD_RPC_OK) {
        return rc;
    }
    *at = msg_copy(text, n);
    return *at != NULL ? SHEARD_RPC_OK : msg_no_memory(r);
}

int msg_read_text(msg_reader *r, const char **at, const msg_member *m, const json_t *value) {
    return read_string(r, at, m->flags, m->max, value);
}

static int read_states(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    unsigned set = 0;
    for (size_t i = 0; i < json_array_size(value); i++) {
        const json_t *item = json_array_get(value, i);
        const int index = name_index(m->names, item);
        const size_t mark = msg_enter_item(r, i);
        if (index < 0) {
            return wrong_name(r, m->names, item);
        }
        set |= 1u << index;
        msg_leave(r, mark);
    }
    *(unsigned *)((char *)message + m->offset) = set;
    return SHEARD_RPC_OK;
}

static int read_item(msg_reader *r, void *at, const msg_member *m, const json_t *value) {
    static const msg_member number = {.type = MSG_INT, .min = 1, .max = INT64_MAX};
    switch (m->type) {
    case MSG_INTS:
        return read_integer(r, at, &number, value);
    case MSG_TEXTS:
        return read_string(r, at, m->flags, m->item_max, value);
    default:
        msg_init(at, m->table);
        return msg_read_object(r, at, m->table, value);
    }
}

static size_t item_size(const msg_member *m) {
    return m->type == MSG_INTS    ? sizeof(int64_t)
           : m->type == MSG_TEXTS ? sizeof(char *)
                                  : m->table->size;
}

/* At every moment the list and its length are what msg_deinit can free. */
static int read_items(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    const size_t n = json_array_size(value);
    char *list = n > 0 ? calloc(n, item_size(m)) : NULL;
    if (n > 0 && list == NULL) {
        return msg_no_memory(r);
    }
    msg_put_pointer(message, m->offset, list);
    *(size_t *)((char *)message + m->count_offset) = n;
    for (size_t i = 0; i < n; i++) {
        const size_t mark = msg_enter_item(r, i);
        const int rc = read_item(r, list + i * item_size(m), m, json_array_get(value, i));
        if (rc != SHEARD_RPC_OK) {
            return rc;
        }
        msg_leave(r, mark);
    }
    return SHEARD_RPC_OK;
}

int msg_read_list(msg_reader *r, void *message, const msg_member *m, const json_t *value) {
    if (!json_is_array(value)) {
        return wrong_type(r, "an array", value);
    }
    const size_t n = json_array_size(value);
    if (strict(r) && m->max > 0 && n > (size_t)m->max) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER,
                        "expected at most %" PRId64 " elements, not %zu", m->max, n);
    }
    if (strict(r) && m->flags & MSG_REQUIRED && n == 0) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected at least one element");
    }
    return m->type == MSG_STATES ? read_states(r, message, m, value)
                                 : read_items(r, message, m, value);
}

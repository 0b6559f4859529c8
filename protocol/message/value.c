/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Initialize, examine and free messages in memory. */
#include "message/table.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Read a pointer of any type: all have one representation here, and memcpy respects the aliasing
 * rules. */
void *msg_pointer(const void *message, size_t offset) {
    void *pointer = NULL;
    memcpy(&pointer, (const char *)message + offset, sizeof pointer);
    return pointer;
}

void msg_put_pointer(void *message, size_t offset, const void *pointer) {
    memcpy((char *)message + offset, &pointer, sizeof pointer);
}

size_t msg_count(const void *message, const msg_member *m) {
    size_t n = 0;
    memcpy(&n, (const char *)message + m->count_offset, sizeof n);
    return n;
}

void msg_put_count(void *message, const msg_member *m, size_t n) {
    memcpy((char *)message + m->count_offset, &n, sizeof n);
}

size_t msg_item_size(const msg_member *m) {
    return m->type == MSG_INTS    ? sizeof(int64_t)
           : m->type == MSG_TEXTS ? sizeof(char *)
                                  : m->table->size;
}

/* Return the C type of a member that is neither an object nor a list. */
static enum member_type memory_of(const msg_member *m) {
    assert(m->table == NULL);
    static const enum member_type types[] = {
        [MSG_BOOL] = MEMBER_BOOL,  [MSG_INT] = MEMBER_INT64,     [MSG_REAL] = MEMBER_DOUBLE,
        [MSG_TEXT] = MEMBER_TEXT,  [MSG_NAME] = MEMBER_INT,      [MSG_TIME] = MEMBER_INT64,
        [MSG_RAW] = MEMBER_TEXT,   [MSG_SETTINGS] = MEMBER_TEXT, [MSG_STATES] = MEMBER_UNSIGNED,
        [MSG_MERGED] = MEMBER_TEXT};
    return types[m->type];
}

static member_value fallback_of(const msg_member *m) {
    switch (m->type) {
    case MSG_BOOL:
        return (member_value){.flag = m->fallback != 0};
    case MSG_INT:
        return (member_value){.count = m->fallback};
    case MSG_REAL:
        return (member_value){.real = NAN};
    case MSG_NAME:
        return (member_value){.number = (int)m->fallback};
    default:
        return (member_value){.text = NULL}; /* the largest: clang initializes no more */
    }
}

static bool is_list(const msg_member *m) {
    return m->type == MSG_INTS || m->type == MSG_TEXTS || m->type == MSG_OBJECTS;
}

/* NOLINTBEGIN(misc-no-recursion): as deep as the tables are nested */

bool msg_is_absent(const void *message, const msg_member *m) {
    const void *at = (const char *)message + m->offset;
    if (m->type == MSG_OBJECT)
        return (m->flags & MSG_NULLABLE) != 0 && !msg_is_there(at, m->table);
    const member_value fallback = fallback_of(m);
    return is_list(m) ? msg_count(message, m) == 0 : member_equal(memory_of(m), at, &fallback);
}

bool msg_is_there(const void *message, const msg_table *table) {
    return !msg_is_absent(message, &table->members[0]);
}

void msg_init(void *message, const msg_table *table) {
    memset(message, 0, table->size);
    for (size_t i = 0; i < table->n; i++) {
        const msg_member *m = &table->members[i];
        void *at = (char *)message + m->offset;
        if (m->type == MSG_OBJECT) {
            msg_init(at, m->table);
        } else if (!is_list(m)) {
            const member_value fallback = fallback_of(m);
            memcpy(at, &fallback, member_size(memory_of(m)));
        }
    }
}

static void free_items(void *message, const msg_member *m) {
    char *list = msg_pointer(message, m->offset);
    const size_t n = list != NULL ? msg_count(message, m) : 0;
    for (size_t i = 0; i < n; i++) {
        char *item = list + i * msg_item_size(m);
        if (m->type == MSG_OBJECTS) {
            msg_deinit(item, m->table);
        } else if (m->type == MSG_TEXTS) {
            free(msg_pointer(item, 0));
        }
    }
    free(list);
}

void msg_deinit(void *message, const msg_table *table) {
    for (size_t i = 0; i < table->n; i++) {
        const msg_member *m = &table->members[i];
        if (m->type == MSG_OBJECT) {
            msg_deinit((char *)message + m->offset, m->table);
        } else if (is_list(m)) {
            free_items(message, m);
        } else if (memory_of(m) == MEMBER_TEXT) {
            free(msg_pointer(message, m->offset));
        }
    }
    memset(message, 0, table->size);
}

/* NOLINTEND(misc-no-recursion) */

const char *msg_name(const char *const *names, int index) {
    for (int i = 0; index >= 0 && names[i] != NULL; i++) {
        if (i == index)
            return names[i];
    }
    return "unknown";
}

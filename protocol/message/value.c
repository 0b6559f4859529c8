/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages in memory: their beginning and their end. */
#include "message/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pointers of any type have one representation here; memcpy keeps clear of the rules of aliasing.
 */
void *msg_pointer(const void *message, size_t offset) {
    void *pointer = NULL;
    memcpy(&pointer, (const char *)message + offset, sizeof pointer);
    return pointer;
}

void msg_put_pointer(void *message, size_t offset, const void *pointer) {
    memcpy((char *)message + offset, &pointer, sizeof pointer);
}

/* NOLINTBEGIN(misc-no-recursion): as deep as the tables are in each other */

static void init_member(void *message, const msg_member *m) {
    void *at = (char *)message + m->offset;
    switch (m->type) {
    case MSG_BOOL:
        *(bool *)at = m->fallback != 0;
        break;
    case MSG_INT:
        *(int64_t *)at = m->fallback;
        break;
    case MSG_REAL:
        *(double *)at = NAN;
        break;
    case MSG_NAME:
        *(int *)at = (int)m->fallback;
        break;
    case MSG_OBJECT:
        msg_init(at, m->table);
        break;
    default: /* all others begin as zero bytes */
        break;
    }
}

void msg_init(void *message, const msg_table *table) {
    memset(message, 0, table->size);
    for (size_t i = 0; i < table->n; i++) {
        init_member(message, &table->members[i]);
    }
}

static void free_items(void *message, const msg_member *m) {
    char *list = msg_pointer(message, m->offset);
    const size_t n = *(const size_t *)((const char *)message + m->count_offset);
    for (size_t i = 0; list != NULL && i < n; i++) {
        if (m->type == MSG_OBJECTS) {
            msg_deinit(list + i * m->table->size, m->table);
        } else if (m->type == MSG_TEXTS) {
            free(msg_pointer(list, i * sizeof(char *)));
        }
    }
    free(list);
}

void msg_deinit(void *message, const msg_table *table) {
    for (size_t i = 0; i < table->n; i++) {
        const msg_member *m = &table->members[i];
        switch (m->type) {
        case MSG_TEXT:
        case MSG_RAW:
        case MSG_SETTINGS:
        case MSG_MERGED:
            free(msg_pointer(message, m->offset));
            break;
        case MSG_INTS:
        case MSG_TEXTS:
        case MSG_OBJECTS:
            free_items(message, m);
            break;
        case MSG_OBJECT:
            msg_deinit((char *)message + m->offset, m->table);
            break;
        default:
            break;
        }
    }
    memset(message, 0, table->size);
}

/* NOLINTEND(misc-no-recursion) */

bool msg_is_there(const void *message, const msg_table *table) {
    const msg_member *first = &table->members[0];
    if (first->type == MSG_INT) {
        return *(const int64_t *)((const char *)message + first->offset) != first->fallback;
    }
    return msg_pointer(message, first->offset) != NULL;
}

char *msg_copy(const char *bytes, size_t n) {
    char *copy = malloc(n + 1);
    if (copy != NULL) {
        memcpy(copy, bytes, n);
        copy[n] = '\0';
    }
    return copy;
}

const char *msg_name(const char *const *names, int index) {
    for (int i = 0; index >= 0 && names[i] != NULL; i++) {
        if (i == index) {
            return names[i];
        }
    }
    return "unknown";
}

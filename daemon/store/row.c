/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/row.h"

#include <stdlib.h>
#include <string.h>

static member_value read_value(query *q, enum member_type type) {
    switch (type) {
    case MEMBER_BOOL:
        return (member_value){.flag = query_get_int(q) != 0};
    case MEMBER_INT:
        return (member_value){.number = (int)query_get_int(q)};
    case MEMBER_UNSIGNED:
        return (member_value){.bits = (unsigned)query_get_int(q)};
    case MEMBER_INT64:
        return (member_value){.count = query_get_int(q)};
    case MEMBER_DOUBLE:
        return (member_value){.real = query_get_real(q)};
    case MEMBER_TEXT:
        return (member_value){.text = query_get_text(q)};
    }
    return (member_value){0};
}

/* Read the present row. */
static int read_row(query *q, const row_type *type, char *row, shear_error *err) {
    memset(row, 0, type->size);
    for (size_t i = 0; i < type->n; i++) {
        const row_member *m = &type->members[i];
        const member_value value = read_value(q, m->type);
        memcpy(row + m->at, &value, member_size(m->type));
    }
    const int code = query_got(q, err);
    if (code != SHEAR_OK)
        row_deinit(type, row);
    return code;
}

int row_next(query *q, const row_type *type, void *row, bool *found, shear_error *err) {
    memset(row, 0, type->size);
    int code = query_step(q, found, err);
    if (*found)
        code = read_row(q, type, row, err);
    *found = *found && code == SHEAR_OK;
    return code;
}

int row_get(query q, const row_type *type, void *row, bool *found, shear_error *err) {
    bool any = false;
    const int code = row_next(&q, type, row, &any, err);
    query_end(&q);
    if (found != NULL)
        *found = any;
    return code;
}

static int read_rows(query *q, const row_type *type, size_t limit, char *rows, size_t *n,
                     bool *more, shear_error *err) {
    for (*n = 0;; (*n)++) {
        TRY(query_step(q, more, err));
        if (!*more || *n == limit)
            return SHEAR_OK;
        TRY(read_row(q, type, rows + *n * type->size, err));
    }
}

int row_list(query q, const row_type *type, size_t limit, void *rows, size_t *n, bool *more,
             shear_error *err) {
    const int code = read_rows(&q, type, limit, rows, n, more, err);
    query_end(&q);
    return code;
}

void row_deinit(const row_type *type, void *row) {
    for (size_t i = 0; i < type->n; i++) {
        if (type->members[i].type == MEMBER_TEXT)
            free(*(char **)(void *)((char *)row + type->members[i].at));
    }
    memset(row, 0, type->size);
}

void row_free(const row_type *type, void *rows, size_t n) {
    for (size_t i = 0; i < n; i++)
        row_deinit(type, (char *)rows + i * type->size);
    free(rows);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/row.h"

#include <stdlib.h>
#include <string.h>

static void read_member(query *q, enum member_type type, void *member) {
    switch (type) {
    case MEMBER_BOOL:
        *(bool *)member = query_get_int(q) != 0;
        break;
    case MEMBER_INT:
        *(int *)member = (int)query_get_int(q);
        break;
    case MEMBER_UNSIGNED:
        *(unsigned *)member = (unsigned)query_get_int(q);
        break;
    case MEMBER_INT64:
        *(int64_t *)member = query_get_int(q);
        break;
    case MEMBER_DOUBLE:
        *(double *)member = query_get_real(q);
        break;
    case MEMBER_TEXT:
        *(char **)member = query_get_text(q);
        break;
    }
}

/* Read the present row. */
static int read_row(query *q, const row_type *type, char *row, shear_error *err) {
    for (size_t i = 0; i < type->n; i++)
        read_member(q, type->members[i].type, row + type->members[i].at);
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

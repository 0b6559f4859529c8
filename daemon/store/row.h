/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/row.h: read the rows of a query into structs, by tables of their members. */
#pragma once

#include "base/member.h"
#include "store/query.h"

typedef struct row_member {
    enum member_type type; /* MEMBER_UNSIGNED also for an enum */
    size_t at;
} row_member;

/* A struct whose members are read from the columns of a statement, in this order. Null is read as
 * 0, NaN or NULL. Texts are owned by the struct. */
typedef struct row_type {
    size_t size;
    const row_member *members;
    size_t n;
} row_type;

/* clang-format off */
#define ROW_MEMBER(T, member)                                                                      \
    {_Generic(((T *)0)->member, bool: MEMBER_BOOL, int: MEMBER_INT, unsigned: MEMBER_UNSIGNED,     \
              int64_t: MEMBER_INT64, double: MEMBER_DOUBLE, char *: MEMBER_TEXT),                  \
     offsetof(T, member)}
/* clang-format on */
#define ROW_TYPE(T, ...)                                                                           \
    {                                                                                              \
        sizeof(T), (const row_member[]){__VA_ARGS__},                                              \
            sizeof((const row_member[]){__VA_ARGS__}) / sizeof(row_member)                         \
    }

/* Step to the next row and read it. *found is false, and the struct zeroed, at the end or on an
 * error. */
int row_next(query *q, const row_type *type, void *row, bool *found, shear_error *err);
/* Read the first row, and end. `found` may be NULL: not wanted. */
int row_get(query q, const row_type *type, void *row, bool *found, shear_error *err);
void row_deinit(const row_type *type, void *row);

/* Read all rows into a zeroed array of `limit` structs, and end. *n is the number of those read,
 * also after an error; *more is true if the query has more rows. */
int row_list(query q, const row_type *type, size_t limit, void *rows, size_t *n, bool *more,
             shear_error *err);
void row_free(const row_type *type, void *rows, size_t n);

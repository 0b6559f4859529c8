/* SPDX-License-Identifier: GPL-3.0-or-later */

/* store/query.h: one use of a cached statement: bind its parameters, step, read the columns in
 * order (row.h reads them into structs), end.
 *
 *     return query_run(QUERY(s, SQL_REQUEUE, query_int(id), query_int(interrupted)), err);
 *
 *     CLEANUP(query_end) query q = QUERY(s, SQL_ATTEMPTS, query_int(id));
 *     TRY(query_step(&q, &row, err));
 *     ... query_get_int(&q) ... */
#pragma once

#include "base/cleanup.h"
#include "store/database.h"

typedef struct query {
    store *s;
    sqlite3_stmt *stmt;
    const char *doing; /* for messages */
    int column;        /* the next one to read in this row */
    int rc;            /* the first error of preparing or binding */
    bool no_memory;    /* a text could not be copied */
} query;

/* The value of a parameter. */
typedef struct parameter {
    int type; /* SQLITE_INTEGER, SQLITE_FLOAT, SQLITE_TEXT or SQLITE_BLOB */
    union {
        int64_t number;
        double real;
        const void *bytes; /* must live until query_end */
    };
    size_t size; /* of a blob */
} parameter;

static inline parameter query_int(int64_t value) {
    return (parameter){.type = SQLITE_INTEGER, .number = value};
}

/* NaN is null. */
static inline parameter query_real(double value) {
    return (parameter){.type = SQLITE_FLOAT, .real = value};
}

/* NULL is null. */
static inline parameter query_text(const char *text) {
    return (parameter){.type = SQLITE_TEXT, .bytes = text};
}

/* Never null. */
static inline parameter query_blob(const unsigned char *bytes, size_t size) {
    return (parameter){.type = SQLITE_BLOB, .bytes = bytes, .size = size};
}

/* Begin a query with all its parameters, in order; query_on: with none. */
#define QUERY(s, which, ...)                                                                       \
    query_with((s), (which), (const parameter[]){__VA_ARGS__},                                     \
               sizeof((const parameter[]){__VA_ARGS__}) / sizeof(parameter))
query query_with(store *s, enum sql which, const parameter *parameters, size_t n);
query query_on(store *s, enum sql which);

/* Step to the next row. *row is true if there is one, false at the end or on error. */
int query_step(query *q, bool *row, shear_error *err);
int64_t query_get_int(query *q);
double query_get_real(query *q); /* NaN if the column is null */
/* Return a value that lives until the next step. A text is NULL if the column is null. */
const unsigned char *query_get_blob(query *q, size_t *size);
const char *query_peek_text(query *q);
/* Return a copy, the caller's, or NULL if the column is null or out of memory (see query_got). */
char *query_get_text(query *q);
/* Return SHEAR_E_NOMEM if a text could not be copied. */
int query_got(const query *q, shear_error *err);
void query_end(query *q); /* may be called twice */

/* Run a statement without rows, then end; query_run_id binds one parameter. */
int query_run(query q, shear_error *err);
int query_run_id(store *s, enum sql which, int64_t id, shear_error *err);
/* Read one number and end: that of the first row, or `otherwise` if there is none or on error. */
int query_number(query q, int64_t otherwise, int64_t *number, shear_error *err);

/* A check of a text: STORE_BAD_TEXT if it has more than `max` bytes or is empty, or if it is NULL
 * and not optional. */
typedef struct text_rule {
    const char *what, *text;
    size_t max;
    bool optional;
} text_rule;
int query_check_texts(const text_rule *rules, size_t n, shear_error *err);

/* SPDX-License-Identifier: GPL-3.0-or-later */

/* store/query.h: one use of a cached statement: bind the parameters in order, step, read the
 * columns in order, end.
 *
 *     CLEANUP(query_end) query q = query_on(s, SQL_JOB_ROW);
 *     query_int(&q, id);
 *     int code = query_step(&q, &row, err);
 *     ... query_get_int(&q) ... */
#pragma once

#include "base/cleanup.h"
#include "store/database.h"

typedef struct query {
    store *s;
    sqlite3_stmt *stmt;
    const char *doing; /* for messages */
    int bound;         /* number of parameters so far */
    int column;        /* the next one to read in this row */
    int rc;            /* the first error of binding */
    bool no_memory;    /* a text could not be copied */
} query;

query query_on(store *s, enum sql which);
void query_int(query *q, int64_t value);
void query_real(query *q, double value, bool null);
void query_text(query *q, const char *text); /* text must live until query_end; NULL: null */
void query_blob(query *q, const unsigned char *bytes, size_t size); /* likewise, but never null */
/* Step to the next row. *row is true if there is one, false at the end or on error. */
int query_step(query *q, bool *row, shear_error *err);
int64_t query_get_int(query *q);
double query_get_real(query *q, bool *null);
/* Return a value that lives until the next step. A text is NULL if the column is null. */
const unsigned char *query_get_blob(query *q, size_t *size);
const char *query_peek_text(query *q);
/* Return a copy, the caller's, or NULL if the column is null or out of memory (see query_got). */
char *query_get_text(query *q);
/* Return SHEAR_E_NOMEM if a text could not be copied. */
int query_got(const query *q, shear_error *err);
void query_end(query *q); /* may be called twice */

/* Run a statement without rows, then end; query_run_id binds one parameter. */
int query_run(query *q, shear_error *err);
int query_run_id(store *s, enum sql which, int64_t id, shear_error *err);
/* Read one number and end: that of the first row, or `otherwise` if there is none or on error. */
int query_number(query *q, int64_t otherwise, int64_t *number, shear_error *err);

/* A check of a text: STORE_BAD_TEXT if it has more than `max` bytes or is empty, or if it is NULL
 * and not optional. */
typedef struct text_rule {
    const char *what, *text;
    size_t max;
    bool optional;
} text_rule;
int query_check_texts(const text_rule *rules, size_t n, shear_error *err);

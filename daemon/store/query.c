/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/query.h"

#include "base/cleanup.h"

#include <assert.h>
#include <math.h>
#include <string.h>

query query_on(store *s, enum sql which) {
    assert(which < SQL_N);
    query q = {.s = s, .doing = sql_texts[which], .stmt = s->statements[which], .rc = SQLITE_OK};
    if (q.stmt == NULL) {
        q.rc = sqlite3_prepare_v3(s->db, sql_texts[which], -1, SQLITE_PREPARE_PERSISTENT, &q.stmt,
                                  NULL);
        s->statements[which] = q.stmt;
    }
    return q;
}

static int bind(sqlite3_stmt *stmt, int at, const parameter *p) {
    switch (p->type) {
    case SQLITE_INTEGER:
        return sqlite3_bind_int64(stmt, at, p->number);
    case SQLITE_FLOAT:
        return sqlite3_bind_double(stmt, at, p->real);
    case SQLITE_TEXT:
        return sqlite3_bind_text(stmt, at, p->bytes, -1, SQLITE_STATIC);
    default: /* a NULL pointer would bind as null */
        return sqlite3_bind_blob64(stmt, at, p->size > 0 ? p->bytes : "", p->size, SQLITE_STATIC);
    }
}

query query_with(store *s, enum sql which, const parameter *parameters, size_t n) {
    query q = query_on(s, which);
    assert(q.rc != SQLITE_OK || n == (size_t)sqlite3_bind_parameter_count(q.stmt));
    for (size_t i = 0; i < n && q.rc == SQLITE_OK; i++)
        q.rc = bind(q.stmt, (int)i + 1, &parameters[i]);
    return q;
}

int query_step(query *q, bool *row, shear_error *err) {
    int rc = q->rc;
    if (rc == SQLITE_OK)
        rc = sqlite3_step(q->stmt);
    *row = rc == SQLITE_ROW;
    q->column = 0;
    if (rc == SQLITE_ROW || rc == SQLITE_DONE)
        return SHEAR_OK;
    const int code = database_fail(q->s->db, q->s->path, rc, q->doing, err);
    /* While the store holds its lock, nobody else can have one, unless the file system does not
     * support locks. */
    if (code == STORE_LOCKED) {
        return shear_fail(err, SHEAR_E_IO, "keep the state directory on a local file system",
                          "%s: lost its lock", q->s->path);
    }
    return code;
}

int64_t query_get_int(query *q) {
    return sqlite3_column_int64(q->stmt, q->column++);
}

double query_get_real(query *q) {
    const int column = q->column++;
    const bool null = sqlite3_column_type(q->stmt, column) == SQLITE_NULL;
    return null ? NAN : sqlite3_column_double(q->stmt, column);
}

const unsigned char *query_get_blob(query *q, size_t *size) {
    const int column = q->column++;
    const unsigned char *bytes = sqlite3_column_blob(q->stmt, column);
    *size = (size_t)sqlite3_column_bytes(q->stmt, column);
    return bytes;
}

const char *query_peek_text(query *q) {
    return (const char *)sqlite3_column_text(q->stmt, q->column++);
}

char *query_get_text(query *q) {
    const char *text = query_peek_text(q);
    char *copy = text != NULL ? strdup(text) : NULL;
    if (copy == NULL && sqlite3_column_type(q->stmt, q->column - 1) != SQLITE_NULL)
        q->no_memory = true;
    return copy;
}

int query_got(const query *q, shear_error *err) {
    return q->no_memory ? shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a job's texts")
                        : SHEAR_OK;
}

void query_end(query *q) {
    if (q->stmt != NULL) {
        sqlite3_reset(q->stmt);
        /* The bound texts are the caller's and may be freed now. */
        sqlite3_clear_bindings(q->stmt);
    }
}

int query_run(query q, shear_error *err) {
    bool row = false;
    const int code = query_step(&q, &row, err);
    query_end(&q);
    return code;
}

int query_run_id(store *s, enum sql which, int64_t id, shear_error *err) {
    return query_run(QUERY(s, which, query_int(id)), err);
}

int query_number(query q, int64_t otherwise, int64_t *number, shear_error *err) {
    bool row = false;
    const int code = query_step(&q, &row, err);
    *number = row ? query_get_int(&q) : otherwise;
    query_end(&q);
    return code;
}

static int check_text(const text_rule *rule, shear_error *err) {
    const char *text = rule->text;
    if (text == NULL) {
        return rule->optional
                   ? SHEAR_OK
                   : shear_fail(err, STORE_BAD_TEXT, NULL, "the %s is missing", rule->what);
    }
    const size_t length = strnlen(text, rule->max + 1);
    if (length > rule->max) {
        return shear_fail(err, STORE_BAD_TEXT, "shorten it", "the %s has more than %zu bytes",
                          rule->what, rule->max);
    }
    if (length == 0)
        return shear_fail(err, STORE_BAD_TEXT, NULL, "the %s is empty", rule->what);
    return SHEAR_OK;
}

int query_check_texts(const text_rule *rules, size_t n, shear_error *err) {
    for (size_t i = 0; i < n; i++)
        TRY(check_text(&rules[i], err));
    return SHEAR_OK;
}

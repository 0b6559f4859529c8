/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/query.h"

#include "base/cleanup.h"

#include <assert.h>
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

void query_int(query *q, int64_t value) {
    if (q->rc == SQLITE_OK)
        q->rc = sqlite3_bind_int64(q->stmt, ++q->bound, value);
}

void query_real(query *q, double value, bool null) {
    if (q->rc == SQLITE_OK) {
        q->bound++;
        q->rc = null ? sqlite3_bind_null(q->stmt, q->bound)
                     : sqlite3_bind_double(q->stmt, q->bound, value);
    }
}

void query_text(query *q, const char *text) {
    if (q->rc == SQLITE_OK) { /* a NULL text binds as null */
        q->rc = sqlite3_bind_text(q->stmt, ++q->bound, text, -1, SQLITE_STATIC);
    }
}

void query_blob(query *q, const unsigned char *bytes, size_t size) {
    if (q->rc == SQLITE_OK) { /* a NULL pointer would bind as null */
        q->rc = sqlite3_bind_blob64(q->stmt, ++q->bound, size > 0 ? (const void *)bytes : "", size,
                                    SQLITE_STATIC);
    }
}

int query_step(query *q, bool *row, shear_error *err) {
    assert(q->stmt == NULL || q->bound == sqlite3_bind_parameter_count(q->stmt) ||
           q->rc != SQLITE_OK);
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

double query_get_real(query *q, bool *null) {
    const int column = q->column++;
    *null = sqlite3_column_type(q->stmt, column) == SQLITE_NULL;
    return sqlite3_column_double(q->stmt, column);
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
    if (sqlite3_column_type(q->stmt, q->column) == SQLITE_NULL) {
        q->column++;
        return NULL;
    }
    const char *text = query_peek_text(q);
    char *copy = text != NULL ? strdup(text) : NULL;
    q->no_memory = q->no_memory || copy == NULL;
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

int query_run(query *q, shear_error *err) {
    bool row = false;
    const int code = query_step(q, &row, err);
    query_end(q);
    return code;
}

int query_run_id(store *s, enum sql which, int64_t id, shear_error *err) {
    query q = query_on(s, which);
    query_int(&q, id);
    return query_run(&q, err);
}

int query_number(query *q, int64_t otherwise, int64_t *number, shear_error *err) {
    bool row = false;
    const int code = query_step(q, &row, err);
    *number = row ? query_get_int(q) : otherwise;
    query_end(q);
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

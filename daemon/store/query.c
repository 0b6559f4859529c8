/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/query.h"

#include <string.h>

query query_on(store *s, enum sql which) {
    query q = {.s = s, .which = which, .stmt = s->statements[which], .rc = SQLITE_OK};
    if (q.stmt == NULL) {
        q.rc = sqlite3_prepare_v3(s->db, sql_texts[which], -1, SQLITE_PREPARE_PERSISTENT, &q.stmt,
                                  NULL);
        s->statements[which] = q.stmt;
    }
    return q;
}

void query_int(query *q, int64_t value) {
    if (q->rc == SQLITE_OK) {
        q->rc = sqlite3_bind_int64(q->stmt, ++q->bound, value);
    }
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
    int rc = q->rc;
    if (rc == SQLITE_OK) {
        rc = sqlite3_step(q->stmt);
    }
    *row = rc == SQLITE_ROW;
    q->column = 0;
    if (rc == SQLITE_ROW || rc == SQLITE_DONE) {
        return SHEAR_OK;
    }
    const int code = database_fail(q->s->db, q->s->path, rc, sql_texts[q->which], err);
    /* Once the database is ours, nobody can be in the way but a file system that plays tricks with
     * locks. */
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

char *query_get_text(query *q) {
    const int column = q->column++;
    if (sqlite3_column_type(q->stmt, column) == SQLITE_NULL) {
        return NULL;
    }
    const char *text = (const char *)sqlite3_column_text(q->stmt, column);
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
        /* Texts of the caller's must not be looked at again. */
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

int query_check_text(const char *what, const char *text, size_t max, bool optional,
                     shear_error *err) {
    if (text == NULL) {
        return optional ? SHEAR_OK
                        : shear_fail(err, STORE_BAD_TEXT, NULL, "the %s is missing", what);
    }
    const size_t length = strnlen(text, max + 1);
    if (length > max) {
        return shear_fail(err, STORE_BAD_TEXT, "shorten it", "the %s has more than %zu bytes", what,
                          max);
    }
    if (length == 0) {
        return shear_fail(err, STORE_BAD_TEXT, NULL, "the %s is empty", what);
    }
    return SHEAR_OK;
}

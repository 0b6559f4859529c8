/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening and closing. */
#include "store/store.h"

#include "store/job.h"
#include "store/lock.h"
#include "store/operation.h"
#include "store/query.h"
#include "store/schema.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* With a slash at least: SQLite takes "file:..." for a URI, "" and ":memory:" for databases without
 * a file. */
static int take_path(store *s, const char *path, shear_error *err) {
    const char *here = path[0] == '/' ? "" : "./";
    if (path[0] == '\0' || strlen(path) + strlen(here) >= sizeof s->path) {
        return shear_fail(err, SHEAR_E_IO, "give a shorter path",
                          "the database's path is empty or too long");
    }
    stpcpy(stpcpy(s->path, here), path);
    return SHEAR_OK;
}

/* Within the transaction that database_connect left open. */
static int bring_up_to_date(store *s, int version, shear_error *err) {
    int code = SHEAR_OK;
    s->opening.created = version < 0;
    s->opening.version = SCHEMA_VERSION;
    s->opening.migrated_from = version < 0 ? SCHEMA_VERSION : version;
    if (version < SCHEMA_VERSION) {
        const int from = version < 0 ? 0 : version;
        code = schema_migrate(s->db, s->path, schema_steps, from, SCHEMA_VERSION, err);
    }
    return code == SHEAR_OK ? database_exec(s->db, s->path, "COMMIT", err) : code;
}

static int read_identity(store *s, shear_error *err) {
    bool row = false;
    query q = query_on(s, SQL_IDENTITY);
    int code = query_step(&q, &row, err);
    char *text = row ? query_get_text(&q) : NULL;
    if (code == SHEAR_OK && row) {
        code = query_got(&q, err);
    }
    query_end(&q);
    if (code == SHEAR_OK && (text == NULL || strlen(text) != sizeof s->identity - 1)) {
        code = shear_fail(err, SHEAR_E_FORMAT, "restore the database from a copy",
                          "%s: does not say which database it is", s->path);
    }
    if (code == SHEAR_OK) {
        stpcpy(s->identity, text);
    }
    free(text);
    return code;
}

static int next_running(store *s, int64_t *id, shear_error *err) {
    bool row = false;
    query q = query_on(s, SQL_RUNNING);
    const int code = query_step(&q, &row, err);
    *id = row ? query_get_int(&q) : 0;
    query_end(&q);
    return code;
}

/* No job can run while the database is being opened: those marked so ran when the service died. */
static int recover(store *s, int64_t now_ms, shear_error *err) {
    int64_t id = 0;
    enum store_state state = STORE_QUEUED;
    int code = operation_begin(s, err);
    if (code != SHEAR_OK) {
        return code;
    }
    do {
        code = next_running(s, &id, err);
        if (code == SHEAR_OK && id != 0) {
            code = job_put_back(s, id, STORE_ATTEMPT_INTERRUPTED, now_ms, &state, err);
            s->opening.requeued += state == STORE_QUEUED;
            s->opening.cancelled += state == STORE_CANCELLED;
        }
    } while (code == SHEAR_OK && id != 0);
    return operation_end(s, code, err);
}

int store_open(store **out, const char *path, const store_options *options, int64_t now_ms,
               shear_error *err) {
    static const store_options plain = {0};
    const store_options *how = options != NULL ? options : &plain;
    int version = 0;
    *out = NULL;
    store *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the store");
    }
    s->lock = -1;
    int code = take_path(s, path, err);
    if (code == SHEAR_OK) {
        code = lock_take(&s->lock, s->path, how->busy_ms, err);
    }
    if (code == SHEAR_OK) {
        code = database_connect(&s->db, s->path, how, &version, err);
    }
    if (code == SHEAR_OK) {
        code = bring_up_to_date(s, version, err);
    }
    if (code == SHEAR_OK) {
        code = database_use_wal(s->db, s->path, err);
    }
    if (code == SHEAR_OK) {
        code = read_identity(s, err);
    }
    if (code == SHEAR_OK) {
        code = recover(s, now_ms, err);
    }
    if (code != SHEAR_OK) {
        store_close(s);
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

void store_close(store *s) {
    if (s == NULL) {
        return;
    }
    for (int i = 0; i < SQL_N; i++) {
        sqlite3_finalize(s->statements[i]);
    }
    /* An open transaction is rolled back; the log is brought into the database and removed. */
    sqlite3_close(s->db);
    if (s->lock >= 0) {
        close(s->lock);
    }
    free(s);
}

const char *store_identity(const store *s) {
    return s->identity;
}

const store_opening *store_opened(const store *s) {
    return &s->opening;
}

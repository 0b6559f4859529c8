/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open and close the store. */
#include "store/store.h"

#include "base/cleanup.h"
#include "store/job.h"
#include "store/lock.h"
#include "store/operation.h"
#include "store/query.h"
#include "store/schema.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void close_failed(store **s) {
    store_close(*s);
}

/* Store the path with at least one slash: SQLite takes "file:..." as a URI, and "" and ":memory:"
 * as databases without a file. */
static int set_path(store *s, const char *path, shear_error *err) {
    const char *here = path[0] == '/' ? "" : "./";
    if (path[0] == '\0' || strlen(path) + strlen(here) >= sizeof s->path) {
        return shear_fail(err, SHEAR_E_IO, "give a shorter path",
                          "the database's path is empty or too long");
    }
    stpcpy(stpcpy(s->path, here), path);
    return SHEAR_OK;
}

/* Make or migrate the schema in the transaction that database_connect left open, and commit. */
static int bring_up_to_date(store *s, int version, shear_error *err) {
    s->opening.created = version < 0;
    s->opening.version = SCHEMA_VERSION;
    s->opening.migrated_from = version < 0 ? SCHEMA_VERSION : version;
    if (version < SCHEMA_VERSION) {
        const int from = version < 0 ? 0 : version;
        TRY(schema_migrate(s->db, s->path, schema_steps, from, SCHEMA_VERSION, err));
    }
    return database_exec(s->db, s->path, "COMMIT", err);
}

static int read_identity(store *s, shear_error *err) {
    bool row = false;
    CLEANUP(query_end) query q = query_on(s, SQL_IDENTITY);
    TRY(query_step(&q, &row, err));
    const char *text = row ? query_peek_text(&q) : NULL;
    if (text == NULL || strlen(text) != sizeof s->identity - 1) {
        return shear_fail(err, SHEAR_E_FORMAT, "restore the database from a copy",
                          "%s: does not say which database it is", s->path);
    }
    stpcpy(s->identity, text);
    return SHEAR_OK;
}

/* No job can run while the database is being opened: jobs marked so were running when the service
 * died. */
static int requeue_running(store *s, int64_t now_ms, shear_error *err) {
    for (;;) {
        int64_t id = 0;
        enum store_state state = STORE_QUEUED;
        TRY(query_number(query_on(s, SQL_RUNNING), 0, &id, err));
        if (id == 0)
            return SHEAR_OK;
        TRY(job_put_back(s, id, STORE_ATTEMPT_INTERRUPTED, now_ms, &state, err));
        assert(state == STORE_QUEUED || state == STORE_CANCELLED);
        s->opening.requeued += state == STORE_QUEUED;
        s->opening.cancelled += state == STORE_CANCELLED;
    }
}

static int open_database(store *s, const store_options *options, int64_t now_ms, shear_error *err) {
    int version = 0;
    TRY(lock_acquire(&s->lock, s->path, options->busy_ms, err));
    TRY(database_connect(&s->db, s->path, options, &version, err));
    TRY(bring_up_to_date(s, version, err));
    TRY(database_use_wal(s->db, s->path, err));
    TRY(read_identity(s, err));
    return OPERATION(s, requeue_running(s, now_ms, err), err);
}

int store_open(store **out, const char *path, const store_options *options, int64_t now_ms,
               shear_error *err) {
    static const store_options plain = {0};
    *out = NULL;
    CLEANUP(close_failed) store *s = calloc(1, sizeof *s);
    if (s == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the store");
    s->lock = -1;
    TRY(set_path(s, path, err));
    TRY(open_database(s, options != NULL ? options : &plain, now_ms, err));
    *out = CLEANUP_TAKE(s);
    return SHEAR_OK;
}

void store_close(store *s) {
    if (s == NULL)
        return;
    for (int i = 0; i < SQL_N; i++)
        sqlite3_finalize(s->statements[i]);
    /* rolls back an open transaction, and copies the log into the database and removes it */
    sqlite3_close(s->db);
    if (s->lock >= 0)
        close(s->lock);
    free(s);
}

const char *store_identity(const store *s) {
    return s->identity;
}

const store_opening *store_opened(const store *s) {
    return &s->opening;
}

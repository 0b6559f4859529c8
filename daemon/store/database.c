/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/database.h"

#include "base/cleanup.h"
#include "store/schema.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

int database_exec(sqlite3 *db, const char *path, const char *sql, shear_error *err) {
    const int rc = sqlite3_exec(db, sql, NULL, NULL, NULL);
    return rc == SQLITE_OK ? SHEAR_OK : database_fail(db, path, rc, "setting up", err);
}

static void statement_finalize(sqlite3_stmt **stmt) {
    sqlite3_finalize(*stmt);
}

/* Prepare a query and step to its first row; return SQLite's result code. */
static int first_row(sqlite3 *db, const char *sql, sqlite3_stmt **stmt) {
    const int rc = sqlite3_prepare_v2(db, sql, -1, stmt, NULL);
    return rc == SQLITE_OK ? sqlite3_step(*stmt) : rc;
}

int database_number(sqlite3 *db, const char *path, const char *sql, int64_t *value,
                    shear_error *err) {
    CLEANUP(statement_finalize) sqlite3_stmt *stmt = NULL;
    const int rc = first_row(db, sql, &stmt);
    *value = rc == SQLITE_ROW ? sqlite3_column_int64(stmt, 0) : 0;
    return rc == SQLITE_ROW || rc == SQLITE_DONE ? SHEAR_OK
                                                 : database_fail(db, path, rc, "reading", err);
}

/* Make the file with mode 0600: SQLite's mode would let others read it, depending on the umask. An
 * existing file is not opened: closing it would drop the locks that this process may hold on it. */
static int make_file(const char *path, shear_error *err) {
    const int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOCTTY, 0600);
    if (fd >= 0) {
        close(fd);
        return SHEAR_OK;
    }
    if (errno == EEXIST)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_IO, "see that the state directory exists and is writable",
                      "%s: cannot be made: %s", path, strerror(errno));
}

/* Set what writes nothing, and take the lock. */
static int prepare(sqlite3 *db, const char *path, int busy_ms, shear_error *err) {
    sqlite3_extended_result_codes(db, 1);
    sqlite3_busy_timeout(db, busy_ms);
    sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
    sqlite3_db_config(db, SQLITE_DBCONFIG_DQS_DML, 0, NULL);
    sqlite3_db_config(db, SQLITE_DBCONFIG_DQS_DDL, 0, NULL);
    /* The exclusive transaction precedes all reads. With this locking mode its end does not release
     * SQLite's lock. */
    return database_exec(db, path,
                         "PRAGMA locking_mode = EXCLUSIVE; PRAGMA synchronous = FULL;"
                         "PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF;"
                         "PRAGMA temp_store = MEMORY; PRAGMA secure_delete = OFF;"
                         "PRAGMA cell_size_check = ON; PRAGMA cache_size = -16384;"
                         "BEGIN EXCLUSIVE",
                         err);
}

/* Check whose database it is, and read its schema's version, or -1 if it is empty. */
static int identify(sqlite3 *db, const char *path, int *version, shear_error *err) {
    int64_t application = 0;
    int64_t written = 0;
    int64_t tables = 0;
    TRY(database_number(db, path, "PRAGMA application_id", &application, err));
    TRY(database_number(db, path, "PRAGMA user_version", &written, err));
    TRY(database_number(db, path, "SELECT count(*) FROM sqlite_schema", &tables, err));
    const bool empty = application == 0 && written == 0 && tables == 0;
    if (!empty && application != SCHEMA_APPLICATION) {
        return shear_fail(err, SHEAR_E_FORMAT, "configure another state directory",
                          "%s: is a database of another program (application id %" PRId64 ")", path,
                          application);
    }
    if (written > SCHEMA_VERSION || written < 0) {
        return shear_fail(err, STORE_NEWER, "install the newer version of the service again",
                          "%s: has schema version %" PRId64
                          ", this version of the service knows %d",
                          path, written, SCHEMA_VERSION);
    }
    *version = empty ? -1 : (int)written;
    return SHEAR_OK;
}

static int connect(sqlite3 **db, const char *path, const store_options *options, int *version,
                   shear_error *err) {
    const int rc =
        sqlite3_open_v2(path, db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, options->vfs);
    if (rc != SQLITE_OK)
        return database_fail(*db, path, rc, "opening", err);
    TRY(prepare(*db, path, options->busy_ms, err));
    return identify(*db, path, version, err);
}

int database_connect(sqlite3 **db, const char *path, const store_options *options, int *version,
                     shear_error *err) {
    *db = NULL;
    TRY(make_file(path, err));
    int code = connect(db, path, options, version, err);
    if (code != SHEAR_OK) {
        sqlite3_close(*db);
        *db = NULL;
    }
    return code;
}

static int start_wal(sqlite3 *db, const char *path, shear_error *err) {
    CLEANUP(statement_finalize) sqlite3_stmt *stmt = NULL;
    const int rc = first_row(db, "PRAGMA journal_mode = WAL", &stmt);
    if (rc != SQLITE_ROW)
        return database_fail(db, path, rc, "starting the write-ahead log", err);
    if (strcmp((const char *)sqlite3_column_text(stmt, 0), "wal") != 0) {
        return shear_fail(err, SHEAR_E_IO, "keep the state directory on a local file system",
                          "%s: a write-ahead log is not possible here", path);
    }
    return SHEAR_OK;
}

int database_use_wal(sqlite3 *db, const char *path, shear_error *err) {
    TRY(start_wal(db, path, err));
    /* The log is truncated to this size after a burst. */
    return database_exec(db, path, "PRAGMA journal_size_limit = 67108864", err);
}

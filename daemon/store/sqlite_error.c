/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convert SQLite's errors to errors of the store. */
#include "store/database.h"
#include "store/lock.h"

#include <errno.h>
#include <string.h>

static const char full_advice[] = "make room on the file system of the state directory";
static const char retry_advice[] = "see that the state directory is there, writable and sound; the "
                                   "operation can be repeated";

typedef struct meaning {
    int result; /* SQLite's primary result code */
    int code;
    const char *advice;
} meaning;

static const meaning meanings[] = {
    {SQLITE_FULL, SHEAR_E_FULL, full_advice},
    {SQLITE_IOERR, SHEAR_E_IO, retry_advice},
    {SQLITE_CANTOPEN, SHEAR_E_IO, retry_advice},
    {SQLITE_READONLY, SHEAR_E_IO, retry_advice},
    {SQLITE_PERM, SHEAR_E_IO, retry_advice},
    {SQLITE_NOMEM, SHEAR_E_NOMEM, NULL},
    {SQLITE_BUSY, STORE_LOCKED, NULL}, /* see lock_fail */
    {SQLITE_CORRUPT, SHEAR_E_FORMAT,
     "stop the service, keep a copy of the state directory, and restore the database"},
    {SQLITE_NOTADB, SHEAR_E_FORMAT,
     "this file is not a database: configure another state directory"},
};

static const meaning *meaning_of(int rc) {
    static const meaning bug = {SQLITE_ERROR, SHEAR_E_INTERNAL, "this is a bug: please report it"};
    for (size_t i = 0; i < sizeof meanings / sizeof meanings[0]; i++) {
        if (meanings[i].result == (rc & 0xff))
            return &meanings[i];
    }
    return &bug;
}

/* Some extended codes of "I/O error" are other errors. */
static int primary_of(int rc) {
    switch (rc) {
    case SQLITE_IOERR_NOMEM:
        return SQLITE_NOMEM;
    case SQLITE_IOERR_CORRUPTFS:
    case SQLITE_IOERR_DATA:
        return SQLITE_CORRUPT;
    default:
        return rc;
    }
}

/* A sync, a truncation or the log's index may fail on a full disk, too, which SQLite reports as an
 * I/O error. */
static const meaning *when_full(const meaning *m, int system_errno) {
    const bool full = system_errno == ENOSPC || system_errno == EDQUOT;
    return m->code == SHEAR_E_IO && full ? meaning_of(SQLITE_FULL) : m;
}

int database_fail(sqlite3 *db, const char *path, int rc, const char *doing, shear_error *err) {
    const meaning *said = meaning_of(primary_of(rc));
    const int system_errno = db != NULL && said->code == SHEAR_E_IO ? sqlite3_system_errno(db) : 0;
    const meaning *m = when_full(said, system_errno);
    if (m->code == STORE_LOCKED)
        return lock_fail(path, err);
    /* The statement comes last: it may be long, and the end of a message is cut off. */
    return shear_fail(err, m->code, m->advice, "%s: %s%s%s (SQLite error %d) while doing: %s", path,
                      db != NULL ? sqlite3_errmsg(db) : sqlite3_errstr(rc),
                      system_errno != 0 ? ": " : "",
                      system_errno != 0 ? strerror(system_errno) : "", rc, doing);
}

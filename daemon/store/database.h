/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/database.h: the store's inside: the connection, its cached statements, and how SQLite's
 * errors become ours. */
#ifndef SHEARD_STORE_DATABASE_H
#define SHEARD_STORE_DATABASE_H

#include "store/sql.h"
#include "store/store.h"

#include <sqlite3.h>

struct store {
    int lock; /* descriptor (lock.h), held while the database is open; -1: none */
    sqlite3 *db;
    sqlite3_stmt *statements[SQL_N]; /* prepared at first use, reset when not in use */
    bool in_group;
    bool group_lost; /* SQLite rolled the group back by itself */
    int lost_code;   /* of the operation that lost it: SHEAR_E_FULL or SHEAR_E_IO */
    store_opening opening;
    char identity[33];
    char path[STORE_PATH_MAX + 1];
};

/* Turn the connection's last error (result code `rc`) into *err; `doing` tells what failed.
 * `path` names the database. */
int database_fail(sqlite3 *db, const char *path, int rc, const char *doing, shear_error *err);
/* Run statements that give no rows and take no parameters. */
int database_exec(sqlite3 *db, const char *path, const char *sql, shear_error *err);
/* The first column of a query's first row as an integer (0 where there is no row). */
int database_number(sqlite3 *db, const char *path, const char *sql, int64_t *value,
                    shear_error *err);

/* Connect to the file, lock it for this connection alone, and check whose it is. Leaves an open
 * exclusive transaction, so that the schema can be made or migrated in it, and the schema's version
 * (0: an empty database). */
int database_connect(sqlite3 **db, const char *path, const store_options *options, int *version,
                     shear_error *err);
/* After that transaction: write-ahead log, fsync at every commit. */
int database_use_wal(sqlite3 *db, const char *path, shear_error *err);

#endif

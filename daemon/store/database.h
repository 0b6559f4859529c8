/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/database.h: struct store: the connection to SQLite and its cached statements; and how
 * SQLite's errors become errors of the store. */
#pragma once

#include "store/sql.h"
#include "store/store.h"

#include <sqlite3.h>

struct store {
    int lock; /* descriptor of the lock file (lock.h), held while the database is open; -1: none */
    sqlite3 *db;
    sqlite3_stmt *statements[SQL_N]; /* prepared at first use and kept */
    bool in_group;
    bool group_lost; /* SQLite has rolled the group back by itself */
    int lost_code;   /* error that caused it: SHEAR_E_FULL or SHEAR_E_IO */
    store_opening opening;
    char identity[33];
    char path[STORE_PATH_MAX + 1];
};

/* Convert the connection's last error (result code `rc`) into *err and return its code. `path`
 * names the database; `doing` describes what failed. */
int database_fail(sqlite3 *db, const char *path, int rc, const char *doing, shear_error *err);
/* Run statements that have no parameters and return no rows. */
int database_exec(sqlite3 *db, const char *path, const char *sql, shear_error *err);
/* Read the first column of a query's first row as an integer, or 0 if there is no row. */
int database_number(sqlite3 *db, const char *path, const char *sql, int64_t *value,
                    shear_error *err);

/* Connect to the file, lock it exclusively, and check that it is a database of the service. Leaves
 * an exclusive transaction open, in which the schema can be made or migrated. *version is the
 * schema's version, or -1 if the database is empty. */
int database_connect(sqlite3 **db, const char *path, const store_options *options, int *version,
                     shear_error *err);
/* Switch to the write-ahead log, with an fsync at every commit. Call after that transaction. */
int database_use_wal(sqlite3 *db, const char *path, shear_error *err);

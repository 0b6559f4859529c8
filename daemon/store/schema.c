/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/schema.h"

#include "base/cleanup.h"

#include <stdio.h>

static int take_step(sqlite3 *db, const char *path, schema_step step, shear_error *err) {
    for (const char *const *sql = step; *sql != NULL; sql++)
        TRY(database_exec(db, path, *sql, err));
    return SHEAR_OK;
}

static int take_steps(sqlite3 *db, const char *path, const schema_step *steps, int from, int to,
                      shear_error *err) {
    char stamp[96];
    for (int v = from; v < to; v++) {
        const int code = take_step(db, path, steps[v], err);
        if (code != SHEAR_OK) {
            shear_prefix(err, code, "schema version %d to %d", v, v + 1);
            return code;
        }
    }
    snprintf(stamp, sizeof stamp, "PRAGMA application_id = %d; PRAGMA user_version = %d",
             SCHEMA_APPLICATION, to);
    return database_exec(db, path, stamp, err);
}

int schema_migrate(sqlite3 *db, const char *path, const schema_step *steps, int from, int to,
                   shear_error *err) {
    sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 0, NULL);
    const int code = take_steps(db, path, steps, from, to, err);
    sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
    return code;
}

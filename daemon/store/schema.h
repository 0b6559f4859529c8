/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/schema.h: the tables, and the migration from every older version of them. What a version
 * changes, and why, is in schema/version_1.sql and so on; the build makes schema_steps of them. */
#pragma once

#include "store/database.h"

enum {
    SCHEMA_APPLICATION = 0x53485244, /* "SHRD" */
    SCHEMA_VERSION = 6
};

/* The statements of a step to the next version, ending in NULL. Released steps are never changed: a
 * new version is a new step. */
typedef const char *const *schema_step;

/* Migrate a database from version `from` to version `to` within the open transaction; steps[v]
 * leads from v to v + 1. */
int schema_migrate(sqlite3 *db, const char *path, const schema_step *steps, int from, int to,
                   shear_error *err);
extern const schema_step schema_steps[SCHEMA_VERSION];

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/schema.h: the tables, and the way from every older version of them to the present one. */
#ifndef SHEARD_STORE_SCHEMA_H
#define SHEARD_STORE_SCHEMA_H

#include "store/database.h"

enum {
    SCHEMA_APPLICATION = 0x53485244, /* "SHRD" */
    SCHEMA_VERSION = 6
};

/* A step to the next version: statements, NULL at the end. Steps that were released are never
 * changed: a new version is a new step. */
typedef const char *const *schema_step;

/* Bring a database from version `from` to version `to` within the transaction that is open;
 * steps[v] leads from v to v + 1. */
int schema_migrate(sqlite3 *db, const char *path, const schema_step *steps, int from, int to,
                   shear_error *err);
extern const schema_step schema_steps[SCHEMA_VERSION];

#endif

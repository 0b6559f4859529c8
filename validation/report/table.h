/* SPDX-License-Identifier: GPL-3.0-or-later */
/* table.h: an experiment's table: printed for people, written as ECSV (astropy's text tables).
 *
 * Columns first, then row by row their cells in order. The first failure (out of memory) is kept;
 * what follows is ignored, and table_save returns it.
 */
#ifndef VALIDATION_TABLE_H
#define VALIDATION_TABLE_H

#include "engine/options.h"

#include <stdio.h>

struct table;

/* Its meta data begin with the experiment, the command, the version and the settings. NULL without
 * memory, which all calls below accept. */
struct table *table_new(const struct request *r);
void table_free(struct table *t);

enum table_kind { TABLE_NUMBER = 0, TABLE_INTEGER, TABLE_TEXT };

/* `digits` after the point when printed for people (a negative number: so many significant ones).
 * `unit` may be "". */
void table_column(struct table *t, const char *name, int kind, int digits, const char *unit,
                  const char *help);
void table_number(struct table *t, double value); /* numbers and integers */
void table_text(struct table *t, const char *text);

/* A line of meta data. The key "verdict" is printed under the table. */
void table_meta(struct table *t, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* For people: aligned columns, then the verdicts. */
void table_print(const struct table *t, FILE *out);
/* OUT/NAME.ecsv, at once or not at all. */
int table_save(const struct table *t, const struct request *r, shear_error *err);

#endif

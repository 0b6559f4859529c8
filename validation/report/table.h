/* SPDX-License-Identifier: GPL-3.0-or-later */
/* table.h: an experiment's table: printed for people, written as ECSV (astropy's text tables).
 *
 * Columns first, then row by row their cells in order.
 */
#ifndef VALIDATION_TABLE_H
#define VALIDATION_TABLE_H

#include "engine/options.h"

typedef struct table table;

/* Its meta data begin with the experiment, the command, the version and the settings. */
table *table_new(const options *o);
void table_free(table *t);

enum table_kind { TABLE_NUMBER = 0, TABLE_INTEGER, TABLE_TEXT };

typedef struct column {
    const char *name; /* "#": the component, in table_components */
    enum table_kind kind;
    int digits; /* after the point when printed for people; negative: significant ones */
    const char *help;
    bool with_error; /* NAME_err follows, "its 1-sigma error" */
    const char *unit;
} column;

/* Append columns, ended by one without a name. */
void table_columns(table *t, const column *columns);
/* The same columns for component 1, then for component 2. */
void table_components(table *t, const column *columns);

/* Append cells of numbers and integers: table_numbers(t, a, b, ...). */
#define table_numbers(t, ...)                                                                      \
    table_add_numbers(t, sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__})
void table_add_numbers(table *t, size_t n, const double *values);
/* Append cells of text: table_texts(t, a, b, ...). */
#define table_texts(t, ...)                                                                        \
    table_add_texts(t, sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *),                     \
                    (const char *[]){__VA_ARGS__})
void table_add_texts(table *t, size_t n, const char *const *texts);

/* A line of meta data; a conclusion (its key is "verdict") is printed under the table. */
void table_meta(table *t, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void table_conclude(table *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* For people: aligned columns, then the conclusions. */
void table_print(const table *t, FILE *out);
/* OUT/NAME.ecsv, at once or not at all. */
void table_save(const table *t, const options *o);

#endif

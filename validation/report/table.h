/* SPDX-License-Identifier: GPL-3.0-or-later */
/* table.h: an experiment's table, printed as text and written as ECSV (astropy's text tables).
 *
 * Add the columns first, then the cells, row by row in their order. */
#pragma once

#include "engine/options.h"

typedef struct table table;

/* Create a table. Its metadata begin with the experiment, the command, the version and the
 * settings. */
table *table_new(const options *o);
void table_free(table *t);

enum table_kind { TABLE_NUMBER = 0, TABLE_INTEGER, TABLE_TEXT };

typedef struct column {
    const char *name; /* "#": a column for each component, whose number replaces it */
    enum table_kind kind;
    int digits; /* decimals in the printed text; negative: significant digits */
    const char *help;
    bool with_error; /* a column NAME_err follows, "its 1-sigma error" */
    const char *unit;
} column;

/* Append columns; the array ends with one without a name. Neighbouring columns with "#" are
 * appended for component 1, then again for component 2. */
void table_columns(table *t, const column *columns);

/* Append cells with numbers and integers: table_numbers(t, a, b, ...). */
#define table_numbers(t, ...)                                                                      \
    table_add_numbers(t, sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__})
void table_add_numbers(table *t, size_t n, const double *values);
/* Append cells with text: table_texts(t, a, b, ...). */
#define table_texts(t, ...)                                                                        \
    table_add_texts(t, sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *),                     \
                    (const char *[]){__VA_ARGS__})
void table_add_texts(table *t, size_t n, const char *const *texts);

/* Add a line of metadata. Those with the key TABLE_CONCLUSION, conclusions, are also printed below
 * the table. */
#define TABLE_CONCLUSION "verdict"
void table_meta(table *t, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Print aligned columns, then the conclusions. */
void table_print(const table *t, FILE *out);
/* Write OUT/NAME.ecsv, completely or not at all. */
void table_save(const table *t, const options *o);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/source_columns.h: which columns of a catalog hold the positions, shapes and flags
 * of its sources: the user's choice ("x=XWIN_IMAGE,..."), else the first of a list of usual names,
 * in any case. */
#pragma once

#include "fits/header/table.h"

enum source_key {
    SOURCE_X = 0,
    SOURCE_Y,
    SOURCE_RA,
    SOURCE_DEC,
    SOURCE_A,
    SOURCE_B,
    SOURCE_THETA,
    SOURCE_ID,
    SOURCE_R_GAL,
    SOURCE_WEIGHT,
    SOURCE_FLAGS,
    SOURCE_KEYS
};

/* The user's choice. */
typedef struct source_names {
    char given[SOURCE_KEYS][SF_NAME]; /* "" = the usual names */
} source_names;

/* Parse "KEY=NAME,..."; NULL chooses nothing. Keys that belong together (x and y; ra and dec; a, b
 * and theta) are given together. SHEAR_E_SETTING. */
int source_names_parse(source_names *names, const char *text, shear_error *err);

/* The columns of one table. */
typedef struct source_columns {
    const sf_table *table;
    const sf_column *by[SOURCE_KEYS]; /* NULL = there is none */
    int64_t first, n;                 /* the rows that are read */
} source_columns;

/* Find the columns. If ra and dec are chosen, but not x and y, there are no x and y.
 * SHEAR_E_FORMAT: there are no positions, or a chosen column is not there or does not hold one
 * number per row; the advice lists the columns that are there. */
int source_columns_find(source_columns *c, const source_names *names, const sf_table *t,
                        shear_error *err);
/* Return whether a column has the name, which decides what its numbers mean. */
bool source_columns_is(const source_columns *c, enum source_key key, const char *name);
/* Return the column of that name if it holds one number per row, else NULL. */
const sf_column *source_columns_number(const sf_table *t, const char *name);

/* Read rows of a column, out[c->n]; angles (ra, dec, theta) are converted to degrees from the unit
 * that TUNITn says. SHEAR_E_FORMAT: the unit is no angle's; and those of sf_table_doubles. */
int source_columns_read(const source_columns *c, enum source_key key, double *out,
                        shear_error *err);

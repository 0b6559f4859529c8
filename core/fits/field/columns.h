/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/columns.h: the columns of a field's CATALOG table. */
#pragma once

#include "fits/field/parts.h"
#include "fits/header/table.h"
#include "shear/field.h"

enum { SF_COLUMNS = 9 };

/* Names, types and units, in the order of enum shear_column's bits, for both reader and writer. */
typedef struct sf_column_def {
    const char *name;
    unsigned bit;     /* one of enum shear_column */
    const char *form; /* TFORM as written */
    const char *unit;
    const char *comment;
} sf_column_def;
extern const sf_column_def sf_column_defs[SF_COLUMNS];

typedef struct sf_columns {
    sf_cards cards; /* of the HDU; empty: there is no CATALOG */
    sf_table table;
    unsigned have; /* or of enum shear_column */
    const sf_column *column[SF_COLUMNS];
    int64_t *scratch; /* [capacity] */
    size_t capacity;
} sf_columns;

/* Open the table of `part`, if there is one; it must have `rows` rows. `part` must outlive *c, and
 * *c must not move: its parts point to each other. Call sf_columns_deinit after an error, too. */
int sf_columns_init(sf_columns *c, const sf_part *part, int64_t rows, shear_error *err);
void sf_columns_deinit(sf_columns *c);

/* Read rows [first, first + count) of one column, which the table must have. Undefined numbers
 * become NaN or `undefined`; integers also if they are not whole (0.5). */
int sf_columns_read_double(sf_columns *c, unsigned bit, int64_t first, int64_t count, double *out,
                           shear_error *err);
int sf_columns_read_int64(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                          int64_t undefined, int64_t *out, shear_error *err);
/* The same; values beyond the range of int32_t are clamped. */
int sf_columns_read_int32(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                          int32_t undefined, int32_t *out, shear_error *err);

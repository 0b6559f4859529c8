/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/columns.h: read the columns of a field's CATALOG table. */
#pragma once

#include "fits/field/parts.h"
#include "fits/header/table.h"
#include "fits/schema/field_columns.h"

typedef struct sf_columns {
    sf_cards cards; /* of the HDU; empty: there is no CATALOG */
    sf_table table;
    unsigned have; /* or of enum shear_column */
    const sf_column *column[SF_COLUMNS];
    int64_t *scratch; /* [capacity] */
    size_t capacity;
} sf_columns;

/* Open the table of `part`, if there is one; it must have `rows` rows. Column PSF_TERMS may have
 * any number of coefficients here. `part` must outlive *c, and *c must not move: its parts point to
 * each other. Call sf_columns_deinit after an error, too. */
int sf_columns_init(sf_columns *c, const sf_part *part, int64_t rows, shear_error *err);
void sf_columns_deinit(sf_columns *c);

/* Read rows [first, first + count) of one column, which the table must have, into numbers of its
 * type. Undefined numbers become NaN or `undefined`; integers also if they are not whole (0.5).
 * Values beyond the range of int32_t are clamped. */
int sf_columns_read(sf_columns *c, const sf_column_def *def, int64_t first, int64_t count,
                    void *out, shear_error *err);

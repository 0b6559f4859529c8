/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/schema/field_columns.h: the columns of a field's CATALOG table, for its reader and writer.
 */
#pragma once

#include "shear/field.h"

enum { SF_COLUMNS = 14 };

/* A column, for both reader and writer. */
typedef struct sf_column_def {
    const char *name;
    unsigned bit;     /* one of enum shear_column */
    const char *form; /* TFORM as written, and the type in memory: K int64_t, D double, J int32_t */
    int repeat;       /* numbers per row; 0: as many as a PSF model has terms */
    const char *unit;
    const char *comment;
    size_t in_rows;    /* offset of its array in shear_catalog_columns */
    size_t in_block;   /* and in shear_block; 0: it has none there */
    int64_t undefined; /* the integer that stands for an undefined one */
} sf_column_def;

/* All columns, in the order of enum shear_column's bits. */
extern const sf_column_def sf_column_defs[SF_COLUMNS];

/* Return the array whose pointer is the member at `offset` of `arrays`. */
void *sf_column_array(const void *arrays, size_t offset);

/* Return the numbers per row of a column. */
static inline int sf_column_repeat(const sf_column_def *def, int terms) {
    return def->repeat > 0 ? def->repeat : terms;
}

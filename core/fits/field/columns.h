/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/columns.h: the columns of a field's CATALOG table. */
#pragma once

#include "fits/field/parts.h"
#include "fits/header/table.h"
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

/* The columns of a table that is being created, as CFITSIO wants them. */
enum { SF_LAYOUT_MAX = 32 };
typedef struct sf_layout {
    int n;
    char *names[SF_LAYOUT_MAX], *forms[SF_LAYOUT_MAX], *units[SF_LAYOUT_MAX];
    const char *comments[SF_LAYOUT_MAX];
    char made[8]; /* TFORM of PSF_TERMS */
} sf_layout;      /* {0} is empty */

/* Append a column; the strings are borrowed. */
void sf_layout_add(sf_layout *l, const char *name, const char *form, const char *unit,
                   const char *comment);
/* Append the columns whose bits are in `columns`; PSF models have `terms`. *l must not move. */
void sf_layout_add_columns(sf_layout *l, unsigned columns, int terms);
/* Return the numbers per row of a column. */
static inline int sf_column_repeat(const sf_column_def *def, int terms) {
    return def->repeat > 0 ? def->repeat : terms;
}

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

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/object_tables.h: which tables of a catalog file hold sources, and the headers of
 * their images.
 *
 * FITS_LDAC has a pair of tables per chip: LDAC_IMHEAD (or FIELDS), one row with the image's
 * header, then LDAC_OBJECTS (OBJECTS). FITS_1.0 has OBJECTS only. Of other files all tables are
 * taken that have positions, and the same columns as the first of them.
 *
 * SExtractor writes the chips of an exposure into one table in ASCII_HEAD, and programs that merge
 * FITS_LDAC tables do so, too. A column EXT_NUMBER or FIELD_POS tells them apart: such a table
 * counts as one for each of its numbers 1, 2, ... */
#pragma once

#include "survey/sources/source_columns.h"

#include "shear/input.h"

enum {
    OBJECT_TABLE_ROWS = 400000000, /* at most */
    OBJECT_TEXT_ROWS = 4000000,    /* the same of a text */
    OBJECT_TABLE_CHIPS = 1000      /* in one table, at most */
};

typedef struct object_table {
    const sf_hdu *hdu;
    int64_t extension;        /* number of the chip whose rows are meant; 0 = all rows */
    char label[SF_NAME + 16]; /* for messages */
    char chip[SF_NAME];       /* EXTNAME of its image, or "" */
    char *header;             /* [cards][80] of its image; NULL if there is none */
    int64_t cards;
} object_table;

typedef struct object_tables {
    object_table *tables; /* [n] */
    int n;
} object_tables;

/* Find the tables, or the HDU or EXTNAME that `part` chooses, and check that they have the columns.
 * SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. Call object_tables_deinit after an error, too. */
int object_tables_init(object_tables *o, const sf_file *file, const shear_input_part *part,
                       const source_names *names, shear_error *err);
void object_tables_deinit(object_tables *o);

/* An open table. It must not move: its parts point to each other. */
typedef struct open_table {
    sf_cards cards;
    sf_table table;
    source_columns columns;
} open_table;

/* Read a table's header and find its columns. Call open_table_deinit after an error, too. */
int open_table_init(open_table *t, const sf_file *file, const object_table *object,
                    const source_names *names, shear_error *err);
void open_table_deinit(open_table *t);
/* Read the number of the chip of n rows. Call it only if object->extension is not 0. */
int open_table_extensions(const open_table *t, int64_t first, int64_t n, int64_t *out,
                          shear_error *err);

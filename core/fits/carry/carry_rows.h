/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/carry/carry_rows.h: read carried columns from their table, and write them, as the bytes that
 * they are stored in. */
#pragma once

#include "fits/carry/carry_list.h"

#include <fitsio.h>

/* Where the cells of a row are: in pieces, each of adjacent columns. */
typedef struct carry_piece {
    int64_t from; /* byte in the table's row */
    int64_t bytes;
} carry_piece;
typedef struct carry_rows {
    sf_rows rows;
    int n;
    carry_piece *pieces; /* [n] */
} carry_rows;

/* Find the columns in the table. `at`: file and HDU for messages. SHEAR_E_NOMEM. Call
 * carry_rows_deinit after an error, too. */
int carry_rows_init(carry_rows *r, const carry_list *l, const sf_table *t, sf_place at,
                    shear_error *err);
void carry_rows_deinit(carry_rows *r);
/* Read the carried cells of a row, which exists: out[l->bytes]. SHEAR_E_IO, SHEAR_E_FORMAT. */
int carry_rows_read(const carry_rows *r, int64_t row, uint8_t *out, shear_error *err);

/* Write the keywords of carried columns that FITS needs beside their names, from column `first` (1
 * is the first) on. */
void carry_write_keys(fitsfile *f, const shear_carried *columns, int n, int first, int *status);
/* Write the carried cells of `count` rows from row `first` (from 0) on: rows[count][bytes]. They
 * are the last of the table's columns. */
void carry_write_rows(fitsfile *f, int64_t first, int count, const uint8_t *rows, int bytes,
                      int *status);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/table.h: a binary table, read without CFITSIO: which columns it has, where they lie
 * in a row, and their numbers.
 *
 * Of columns that nobody asks for only TFORMn is looked at, which says how wide they are.
 */
#ifndef SHEAR_FITS_HEADER_TABLE_H
#define SHEAR_FITS_HEADER_TABLE_H

#include "fits/header/cards.h"

typedef struct sf_column {
    char name[SF_NAME]; /* TTYPEn; "" = none */
    char type;          /* of TFORMn: L X B I J K A E D C M P Q; '\0' = not seen yet */
    char element;       /* of a variable length (P, Q): the type of what it points to */
    int64_t repeat;
    int64_t offset, width;           /* bytes in the row */
    const char *scale, *zero, *null; /* cards of TSCALn, TZEROn, TNULLn, or NULL */
    bool twice;                      /* one of these stands in the header twice */
} sf_column;

typedef struct sf_table {
    const sf_file *file;
    const sf_hdu *hdu;
    const sf_cards *cards;
    sf_column *columns; /* [n] */
    int n;
} sf_table;

/* `cards` are those of `hdu`, a binary table; all outlive *t. Deinit it, also after an error.
 * SHEAR_E_FORMAT: a TFORMn is missing, unknown or twice there; they do not add up to NAXIS1. */
int sf_table_init(sf_table *t, const sf_file *file, const sf_hdu *hdu, const sf_cards *cards,
                  shear_error *err);
void sf_table_deinit(sf_table *t);

/* The column of that name, in any case; NULL if it is absent. SHEAR_E_FORMAT: there are two. */
int sf_table_find(const sf_table *t, const char *name, const sf_column **column, shear_error *err);
/* The same, and it must hold one number (or logical) per row, with sound TSCALn, TZEROn, TNULLn. */
int sf_table_find_number(const sf_table *t, const char *name, const sf_column **column,
                         shear_error *err);

/* Rows [first, first + count) of a column of numbers; logicals are 0 and 1. Undefined ones (TNULLn,
 * and logicals that are neither) are NaN. */
int sf_table_doubles(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                     double *out, shear_error *err);
/* The same as integers, exactly where the column's are. Undefined ones, and those that are not
 * whole or beyond 64 bits, are `undefined`. Unsigned numbers of 64 bits (TZERO 2^63) come as their
 * bits. */
int sf_table_integers(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                      int64_t undefined, int64_t *out, shear_error *err);
/* Does it hold unsigned numbers of 64 bits? */
bool sf_column_is_unsigned(const sf_column *column);

/* `bytes` of row `row` from `offset` on in it. SHEAR_E_IO, SHEAR_E_FORMAT. */
int sf_table_bytes(const sf_table *t, int64_t row, int64_t offset, int64_t bytes, void *out,
                   shear_error *err);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/table.h: a binary table, read without CFITSIO: its columns, their place in a row, and
 * their numbers.
 *
 * Of columns that are not looked up, only TFORMn is checked, because it gives their width. */
#pragma once

#include "fits/header/cards.h"
#include "fits/header/rows.h"

/* How a column's stored numbers are converted: scale * number + zero; `null` is undefined. */
typedef struct sf_scaling {
    const char *scale_card, *zero_card, *null_card; /* of TSCALn, TZEROn, TNULLn, or NULL */
    bool twice;                                     /* one of them appears twice */
    const char *wrong;                              /* what is wrong with them, or NULL */
    double scale, zero;
    bool has_null;
    int64_t null;
    bool whole; /* scale is 1 and zero an integer (whole_zero), so that integers stay exact */
    int64_t whole_zero;
    bool is_unsigned; /* unsigned numbers of 64 bits: TZERO is 2^63 */
} sf_scaling;

typedef struct sf_column {
    char name[SF_NAME]; /* TTYPEn; "" = none */
    char type;          /* of TFORMn: L X B I J K A E D C M P Q; '\0' = not seen yet */
    char element;       /* for a variable length (P, Q): the type of the elements it points to */
    int64_t repeat;
    int64_t offset, width; /* bytes in a row */
    sf_scaling by;
} sf_column;

typedef struct sf_table {
    const sf_cards *cards;
    sf_column *columns; /* [n] */
    int n;
} sf_table;

/* Parse the columns. `cards` are those of a binary table, and must outlive *t.
 * SHEAR_E_FORMAT: a TFORMn is missing, unknown or repeated, or they do not add up to NAXIS1. Call
 * sf_table_deinit after an error, too. */
int sf_table_init(sf_table *t, const sf_cards *cards, shear_error *err);
void sf_table_deinit(sf_table *t);

/* Find the column called `name`, ignoring case; *column is NULL if it is absent. SHEAR_E_FORMAT:
 * there are two. */
int sf_table_find(const sf_table *t, const char *name, const sf_column **column, shear_error *err);
/* The same for a column that must hold one number (or logical) per row, with valid TSCALn, TZEROn,
 * TNULLn. */
int sf_table_find_number(const sf_table *t, const char *name, const sf_column **column,
                         shear_error *err);

/* The same for a column that must hold `repeat` numbers per row, 1 or more. */
int sf_table_find_numbers(const sf_table *t, const char *name, const sf_column **column,
                          shear_error *err);
/* Read the axes of its cells from TDIMn, the fastest first; those beyond are 1. Without TDIMn there
 * is one, the repeat count. SHEAR_E_FORMAT: they are not positive, more than SF_AXES, or not the
 * repeat count in all. */
int sf_table_shape(const sf_table *t, const sf_column *column, int64_t axes[SF_AXES],
                   shear_error *err);
/* Write for the user who named a column that is not there: "did you mean NAME? columns: NAME, ...",
 * cut to `size`. "" lists the columns only. */
void sf_table_advise(const sf_table *t, const char *name, char *out, size_t size);

/* Read rows [first, first + count) of a column of numbers; logicals are 0 and 1. Undefined values
 * (TNULLn, and logicals that are neither) are NaN. */
int sf_table_doubles(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                     double *out, shear_error *err);
/* The same as integers, exact if the column holds integers. Undefined values, and those that are
 * not whole or beyond 64 bits, become `undefined`. Unsigned numbers of 64 bits are returned as
 * their bits. */
int sf_table_integers(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                      int64_t undefined, int64_t *out, shear_error *err);

/* Read all numbers of one row of a column: out[repeat]. */
int sf_table_cell(const sf_table *t, const sf_column *column, int64_t row, double *out,
                  shear_error *err);
/* Read a column of characters (TFORM A) in one row, without trailing blanks; what does not fit is
 * cut off, and characters that are not printable become '?'. */
int sf_table_text(const sf_table *t, const sf_column *column, int64_t row, char *out, size_t size,
                  shear_error *err);

/* Return where its rows lie. */
sf_rows sf_table_rows(const sf_table *t);
/* Read `bytes` bytes of row `row`, from `offset` in the row: sf_rows_bytes(). */
int sf_table_bytes(const sf_table *t, int64_t row, int64_t offset, int64_t bytes, void *out,
                   shear_error *err);

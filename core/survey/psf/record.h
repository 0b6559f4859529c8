/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/record.h: the parameters of a PSF model in a table HDU: columns of one row, or else
 * keywords of the header. Names in any case.
 *
 * Functions that read a number leave it unchanged if it is absent. */
#pragma once

#include "fits/header/table.h"

typedef struct psf_record {
    char label[SF_NAME]; /* of the HDU, for messages */
    sf_cards cards;
    sf_table table;
    int64_t rows;
    int64_t row; /* the one that is read, from 0 */
} psf_record;

/* Write the HDU's EXTNAME, or else its number, into label[SF_NAME]. */
void psf_label(const sf_hdu *hdu, char *label);

/* Return whether the HDU is a table with rows that can be opened. */
bool psf_record_is_table(const sf_hdu *hdu);
/* Open the table at row 0. *r must not move. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM; it has no
 * row. Call psf_record_deinit after an error, too. */
int psf_record_init(psf_record *r, const sf_file *file, const sf_hdu *hdu, shear_error *err);
void psf_record_deinit(psf_record *r);

/* SHEAR_E_FORMAT: not a finite number, not an integer in [min, max]. */
int psf_record_double(const psf_record *r, const char *name, double *value, shear_error *err);
int psf_record_int(const psf_record *r, const char *name, int min, int max, int *value,
                   shear_error *err);
/* Read a text; "" if it is absent. */
int psf_record_text(const psf_record *r, const char *name, char *out, size_t size,
                    shear_error *err);
/* Read all numbers of a column that must be there; *values is malloc'd. `axes`: sf_table_shape().
 * SHEAR_E_FORMAT: there are more than 2^26. */
int psf_record_array(const psf_record *r, const char *name, int64_t axes[SF_AXES], double **values,
                     shear_error *err);

/* Find the least and the largest number of a column that is scanned whole; NaN if it has none, or
 * there is no such column. */
int psf_record_range(const psf_record *r, const char *name, double *min, double *max,
                     shear_error *err);

/* Fail: "keyword or column NAME ...". */
int psf_record_fail(const psf_record *r, const char *name, const char *what, shear_error *err);

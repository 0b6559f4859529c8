/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/record.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_NUMBERS = 1 << 26, CHUNK = 256 };

void psf_label(const sf_hdu *hdu, char *label) {
    text_set(label, SF_NAME, hdu->name);
    if (label[0] == '\0')
        snprintf(label, SF_NAME, "%d (from 0)", hdu->number);
}

bool psf_record_is_table(const sf_hdu *hdu) {
    return hdu->kind == SF_TABLE && !hdu->zimage && !hdu->ztable && hdu->axes[1] > 0;
}

int psf_record_init(psf_record *r, const sf_file *file, const sf_hdu *hdu, shear_error *err) {
    *r = (psf_record){0};
    psf_label(hdu, r->label);
    TRY(sf_cards_init(&r->cards, file, hdu, r->label, err));
    if (hdu->ztable || hdu->zimage) {
        return sf_fail(err, SHEAR_E_FORMAT, r->cards.at, "unpack the file with funpack",
                       "must be a table; compressed tables are not read");
    }
    TRY(sf_table_init(&r->table, &r->cards, err));
    r->rows = hdu->axes[1];
    return r->rows > 0 ? SHEAR_OK
                       : sf_fail(err, SHEAR_E_FORMAT, r->cards.at, NULL, "the table has no row");
}

void psf_record_deinit(psf_record *r) {
    sf_table_deinit(&r->table);
    sf_cards_deinit(&r->cards);
}

int psf_record_fail(const psf_record *r, const char *name, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, r->cards.at, "write the PSF model again",
                   "keyword or column %s %s", name, what);
}

int psf_record_double(const psf_record *r, const char *name, double *value, shear_error *err) {
    const sf_column *column = NULL;
    double v = NAN;
    TRY(sf_table_find_number(&r->table, name, &column, err));
    if (column == NULL)
        return sf_key_double(&r->cards, name, value, err);
    TRY(sf_table_doubles(&r->table, column, r->row, 1, &v, err));
    if (!isfinite(v))
        return psf_record_fail(r, name, "is not a finite number", err);
    *value = v;
    return SHEAR_OK;
}

int psf_record_int(const psf_record *r, const char *name, int min, int max, int *value,
                   shear_error *err) {
    double v = *value;
    char what[80];
    TRY(psf_record_double(r, name, &v, err));
    if (v == *value)
        return SHEAR_OK;
    if (!(v >= min && v <= max) || v != floor(v)) {
        snprintf(what, sizeof what, "is %g, but must be an integer from %d to %d", v, min, max);
        return psf_record_fail(r, name, what, err);
    }
    *value = (int)v;
    return SHEAR_OK;
}

int psf_record_text(const psf_record *r, const char *name, char *out, size_t size,
                    shear_error *err) {
    const sf_column *column = NULL;
    TRY(sf_table_find(&r->table, name, &column, err));
    if (column != NULL && column->type == 'A')
        return sf_table_text(&r->table, column, r->row, out, size, err);
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(&r->cards, name, &text, err));
    text_set(out, size, text);
    sf_make_printable(out);
    return SHEAR_OK;
}

int psf_record_array(const psf_record *r, const char *name, int64_t axes[SF_AXES], double **values,
                     shear_error *err) {
    const sf_column *column = NULL;
    TRY(sf_table_find_numbers(&r->table, name, &column, err));
    if (column == NULL)
        return psf_record_fail(r, name, "is missing", err);
    TRY(sf_table_shape(&r->table, column, axes, err));
    if (column->repeat > MOST_NUMBERS)
        return psf_record_fail(r, name, "has more than 2^26 numbers", err);
    CLEANUP(release_free) double *v = malloc((size_t)column->repeat * sizeof *v);
    if (v == NULL)
        return sf_fail_memory(err, r->cards.at);
    TRY(sf_table_cell(&r->table, column, r->row, v, err));
    *values = CLEANUP_TAKE(v);
    return SHEAR_OK;
}

int psf_record_range(const psf_record *r, const char *name, double *min, double *max,
                     shear_error *err) {
    const sf_column *column = NULL;
    double v[CHUNK];
    *min = *max = NAN;
    TRY(sf_table_find_number(&r->table, name, &column, err));
    for (int64_t row = 0; column != NULL && row < r->rows; row += CHUNK) {
        const int64_t n = r->rows - row < CHUNK ? r->rows - row : CHUNK;
        TRY(sf_table_doubles(&r->table, column, row, n, v, err));
        for (int64_t i = 0; i < n; i++) { /* fmin and fmax ignore NaN */
            *min = fmin(*min, v[i]);
            *max = fmax(*max, v[i]);
        }
    }
    return SHEAR_OK;
}

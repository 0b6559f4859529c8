/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const sf_column_def sf_column_defs[SF_COLUMNS] = {
    {"ID", SHEAR_COL_ID, "K", "", "the galaxy's number"},
    {"X", SHEAR_COL_X, "D", "pixel", "position in the exposure"},
    {"Y", SHEAR_COL_Y, "D", "pixel", "position in the exposure"},
    {"RA", SHEAR_COL_RA, "D", "deg", "right ascension"},
    {"DEC", SHEAR_COL_DEC, "D", "deg", "declination"},
    {"WEIGHT", SHEAR_COL_WEIGHT, "D", "", "weight in the field's sums"},
    {"PSF_ID", SHEAR_COL_PSF_ID, "J", "", "which image of HDU PSF, from 0"},
    {"R_GAL", SHEAR_COL_R_GAL, "D", "pixel", "scale radius R_G for the filter"},
    {"FLAGS", SHEAR_COL_FLAGS, "J", "", "non-zero = leave the stamp out"},
};

int sf_find_number_column(fitsfile *fits, sf_place at, const char *name, int *number,
                          shear_error *err) {
    int status = 0;
    char template[FLEN_VALUE];
    snprintf(template, sizeof template, "%s", name);
    *number = 0;
    fits_get_colnum(fits, CASEINSEN, template, number, &status);
    if (status == COL_NOT_FOUND) {
        fits_clear_errmsg();
        *number = 0;
        return SHEAR_OK;
    }
    if (status == COL_NOT_UNIQUE) {
        fits_clear_errmsg();
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "it has two columns called %s", name);
    }
    int type = 0;
    long repeat = 0;
    long width = 0;
    fits_get_coltype(fits, *number, &type, &repeat, &width, &status);
    if (status != 0) {
        return sf_fail_status(err, at, status, name);
    }
    const bool number_type = type == TBYTE || type == TSHORT || type == TLONG ||
                             type == TLONGLONG || type == TFLOAT || type == TDOUBLE;
    if (!number_type || repeat != 1) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "correct the column, or rename it",
                       "column %s must hold one number a row (TFORM B, I, J, K, E or D), but %s",
                       name,
                       type < 0          ? "has a variable length"
                       : type == TSTRING ? "holds strings"
                       : repeat != 1     ? "has another repeat count"
                                         : "has another type");
    }
    return SHEAR_OK;
}

static int check_table(const sf_hdu *hdu, sf_place at, int64_t rows, shear_error *err) {
    if (hdu->ztable || hdu->zimage) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "unpack the file with funpack",
                       "compressed tables are not read");
    }
    if (hdu->kind != SF_TABLE || hdu->naxis != 2) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be a binary table (BINTABLE)");
    }
    if (hdu->axes[1] != rows) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "give it one row a stamp, in stamp order",
                       "it has %lld rows, but there are %lld galaxy stamps",
                       (long long)hdu->axes[1], (long long)rows);
    }
    return SHEAR_OK;
}

int sf_columns_init(sf_columns *c, const sf_part *part, int64_t rows, shear_error *err) {
    *c = (sf_columns){.at = {part->file->source.name, part->label}};
    if (part->hdu == NULL) {
        return SHEAR_OK;
    }
    int rc = check_table(part->hdu, c->at, rows, err);
    if (rc == SHEAR_OK) {
        rc = sf_open_hdu(part->file, part->hdu->number, part->label, &c->fits, err);
    }
    for (int i = 0; rc == SHEAR_OK && i < SF_COLUMNS; i++) {
        rc = sf_find_number_column(c->fits, c->at, sf_column_defs[i].name, &c->number[i], err);
        c->have |= c->number[i] > 0 ? sf_column_defs[i].bit : 0u;
    }
    return rc;
}

void sf_columns_deinit(sf_columns *c) {
    sf_close_hdu(c->fits);
    c->fits = NULL;
    free(c->scratch);
    c->scratch = NULL;
}

static int index_of(unsigned bit) {
    return __builtin_ctz(bit);
}

static int result(const sf_columns *c, unsigned bit, int status, shear_error *err) {
    if (status == 0) {
        return SHEAR_OK;
    }
    char doing[64];
    snprintf(doing, sizeof doing, "column %s cannot be read", sf_column_defs[index_of(bit)].name);
    return sf_fail_status(err, c->at, status, doing);
}

int sf_columns_read_double(sf_columns *c, unsigned bit, int64_t first, int64_t count, double *out,
                           shear_error *err) {
    int status = 0;
    int any_null = 0; /* not NULL: CFITSIO 4.2 writes to it unasked where a table holds NaN */
    double null = NAN;
    fits_read_col(c->fits, TDOUBLE, c->number[index_of(bit)], first + 1, 1, count, &null, out,
                  &any_null, &status);
    return result(c, bit, status, err);
}

/* Into c->scratch. */
static int read_integers(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                         int64_t undefined, shear_error *err) {
    if (count > c->scratch_size) {
        LONGLONG *grown = realloc(c->scratch, (size_t)count * sizeof *grown);
        if (grown == NULL) {
            return sf_fail_memory(err, c->at);
        }
        c->scratch = grown;
        c->scratch_size = count;
    }
    int status = 0;
    int any_null = 0; /* not NULL, as above */
    LONGLONG null = undefined;
    fits_read_col(c->fits, TLONGLONG, c->number[index_of(bit)], first + 1, 1, count, &null,
                  c->scratch, &any_null, &status);
    return result(c, bit, status, err);
}

int sf_columns_read_int64(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                          int64_t undefined, int64_t *out, shear_error *err) {
    const int rc = read_integers(c, bit, first, count, undefined, err);
    for (int64_t i = 0; rc == SHEAR_OK && i < count; i++) {
        out[i] = c->scratch[i];
    }
    return rc;
}

int sf_columns_read_int32(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                          int32_t undefined, int32_t *out, shear_error *err) {
    const int rc = read_integers(c, bit, first, count, undefined, err);
    for (int64_t i = 0; rc == SHEAR_OK && i < count; i++) {
        const LONGLONG v = c->scratch[i];
        out[i] = v > INT32_MAX ? INT32_MAX : v < INT32_MIN ? INT32_MIN : (int32_t)v;
    }
    return rc;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/catalog_header.h"
#include "fits/catalog_schema.h"
#include "fits/columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One column of doubles into a member of all rows; NaN where the table has no such column. */
static int read_member(fitsfile *fits, sf_place at, const sf_member *m, double *values,
                       shear_catalog_table *t, shear_error *err) {
    int number = 0;
    int status = 0;
    int any_null = 0; /* not NULL: CFITSIO 4.2 writes to it unasked where a table holds NaN */
    double null = NAN;
    const int rc = sf_find_number_column(fits, at, m->name, &number, err);
    if (rc != SHEAR_OK) {
        return rc;
    }
    if (number > 0) {
        fits_read_col(fits, TDOUBLE, number, 1, 1, t->n, &null, values, &any_null, &status);
    }
    for (int64_t i = 0; i < t->n; i++) {
        const double value = number > 0 && status == 0 ? values[i] : NAN;
        memcpy((char *)&t->rows[i] + m->offset, &value, sizeof value);
    }
    return status == 0 ? SHEAR_OK : sf_fail_status(err, at, status, m->name);
}

static int read_flags(fitsfile *fits, sf_place at, double *values, shear_catalog_table *t,
                      shear_error *err) {
    int number = 0;
    int status = 0;
    int any_null = 0;
    const int rc = sf_find_number_column(fits, at, "FLAGS", &number, err);
    if (rc != SHEAR_OK || number == 0) {
        return rc;
    }
    fits_read_col(fits, TDOUBLE, number, 1, 1, t->n, NULL, values, &any_null, &status);
    for (int64_t i = 0; status == 0 && i < t->n; i++) {
        t->rows[i].flags = values[i] >= 0.0 && values[i] <= UINT32_MAX ? (uint32_t)values[i] : 0u;
    }
    return status == 0 ? SHEAR_OK : sf_fail_status(err, at, status, "FLAGS");
}

static int read_rows(fitsfile *fits, sf_place at, shear_catalog_table *t, shear_error *err) {
    int rc = SHEAR_OK;
    double *values = calloc((size_t)t->n + 1, sizeof *values);
    t->rows = calloc((size_t)t->n + 1, sizeof *t->rows);
    if (values == NULL || t->rows == NULL) {
        rc = sf_fail_memory(err, at);
        goto done;
    }
    for (int64_t i = 0; i < t->n; i++) { /* members without a column */
        t->rows[i].flux_removed = NAN;
        t->rows[i].border_mean = NAN;
        t->rows[i].border_var = NAN;
        t->rows[i].border_var_noise = NAN;
    }
    for (int i = 0; rc == SHEAR_OK && i < SF_CATALOG_MEMBERS; i++) {
        rc = read_member(fits, at, &sf_catalog_members[i], values, t, err);
    }
    if (rc == SHEAR_OK) {
        rc = read_flags(fits, at, values, t, err);
    }
done:
    free(values);
    return rc;
}

/* A table that has not even these columns is no result catalogue; and its rows may be so narrow
 * that a small file would ask for much memory. */
static int check_columns(fitsfile *fits, sf_place at, shear_error *err) {
    static const char *const needed[] = {"N1", "N2", "D", "FLAGS"};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        int number = 0;
        const int rc = sf_find_number_column(fits, at, needed[i], &number, err);
        if (rc != SHEAR_OK) {
            return rc;
        }
        if (number == 0) {
            return sf_fail(err, SHEAR_E_FORMAT, at, "give a result catalogue of this software",
                           "it has no column %s", needed[i]);
        }
    }
    return SHEAR_OK;
}

static int read_table(const sf_file *file, shear_catalog_table *t, shear_error *err) {
    const sf_place at = {file->source.name, SF_CATALOG_HDU};
    const sf_hdu *hdu = NULL;
    fitsfile *fits = NULL;
    int rc = sf_survey_find(&file->survey, SF_CATALOG_HDU, true, &hdu, err);
    if (rc == SHEAR_OK &&
        (hdu->kind != SF_TABLE || hdu->naxis != 2 || hdu->zimage || hdu->ztable)) {
        rc = sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be a plain binary table (BINTABLE)");
    }
    if (rc == SHEAR_OK) {
        rc = sf_open_hdu(file, hdu->number, SF_CATALOG_HDU, &fits, err);
    }
    if (rc == SHEAR_OK) {
        rc = check_columns(fits, at, err);
    }
    if (rc == SHEAR_OK) {
        t->n = hdu->axes[1];
        rc = sf_catalog_read_header(fits, file->source.name, t, err);
    }
    if (rc == SHEAR_OK) {
        rc = read_rows(fits, at, t, err);
    }
    sf_close_hdu(fits);
    return rc;
}

int shear_catalog_read(shear_catalog_table **table, const char *path, shear_error *err) {
    *table = NULL;
    shear_catalog_table *t = calloc(1, sizeof *t);
    if (t == NULL) {
        return sf_fail_memory(err, (sf_place){path, NULL});
    }
    sf_file file;
    int rc = sf_file_open(&file, path, err);
    if (rc == SHEAR_OK) {
        rc = read_table(&file, t, err);
        sf_file_close(&file);
    }
    if (rc != SHEAR_OK) {
        shear_catalog_table_free(t);
        return rc;
    }
    *table = t;
    return SHEAR_OK;
}

void shear_catalog_table_free(shear_catalog_table *t) {
    if (t != NULL) {
        free(t->rows);
        free(t);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read result catalogs. */
#include "base/cleanup.h"
#include "fits/catalog/keywords.h"
#include "fits/header/table.h"
#include "fits/schema/result_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Read a column into a member of all rows. Without the column it is NaN, or an integer as if the
 * file had 0. `values` is memory for t->n numbers. */
static int read_member(const sf_table *table, const sf_member *m, double *values,
                       shear_catalog_table *t, shear_error *err) {
    const sf_column *column = NULL;
    TRY(sf_table_find_number(table, m->name, &column, err));
    if (column != NULL)
        TRY(sf_table_doubles(table, column, 0, t->n, values, err));
    for (int64_t i = 0; i < t->n; i++) {
        char *member = (char *)&t->rows[i] + m->offset;
        const double value = column != NULL ? values[i] : NAN;
        const bool valid = value >= (double)m->shift && value <= (double)m->most;
        const uint32_t integer = (uint32_t)((valid ? (int64_t)value : 0) - m->shift);
        if (m->form[0] == 'D') {
            memcpy(member, &value, sizeof value);
        } else {
            memcpy(member, &integer, sizeof integer);
        }
    }
    return SHEAR_OK;
}

static int read_rows(const sf_table *table, shear_catalog_table *t, shear_error *err) {
    /* The members without a column. */
    const shear_row unknown = {.flux_removed = NAN,
                               .border_mean = NAN,
                               .border_var = NAN,
                               .border_var_noise = NAN,
                               .border_step_x = NAN,
                               .border_step_y = NAN,
                               .border_step2 = NAN};
    CLEANUP(release_free) double *values = calloc((size_t)t->n + 1, sizeof *values);
    t->rows = calloc((size_t)t->n + 1, sizeof *t->rows);
    if (values == NULL || t->rows == NULL)
        return sf_fail_memory(err, table->cards->at);
    for (int64_t i = 0; i < t->n; i++)
        t->rows[i] = unknown;
    for (int i = 0; i < SF_CATALOG_MEMBERS; i++)
        TRY(read_member(table, &sf_catalog_members[i], values, t, err));
    return SHEAR_OK;
}

/* A table without these columns is not a result catalog; and its rows may be so narrow that a small
 * file would cause a large allocation. */
static int check_columns(const sf_table *table, shear_error *err) {
    static const char *const needed[] = {"N1", "N2", "D", "FLAGS"};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        const sf_column *column = NULL;
        TRY(sf_table_find_number(table, needed[i], &column, err));
        if (column == NULL) {
            return sf_fail(err, SHEAR_E_FORMAT, table->cards->at,
                           "give a result catalog of this software", "it has no column %s",
                           needed[i]);
        }
    }
    return SHEAR_OK;
}

static int read_table(const sf_file *file, shear_catalog_table *t, shear_error *err) {
    const sf_hdu *hdu = NULL;
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    CLEANUP(sf_table_deinit) sf_table table = {0};
    TRY(sf_file_find(file, SF_CATALOG_HDU, true, &hdu, err));
    if (hdu->kind != SF_TABLE || hdu->zimage || hdu->ztable) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, SF_CATALOG_HDU}, NULL,
                       "must be a plain binary table (BINTABLE)");
    }
    TRY(sf_cards_init(&cards, file, hdu, SF_CATALOG_HDU, err));
    TRY(sf_table_init(&table, &cards, err));
    TRY(check_columns(&table, err));
    t->n = hdu->axes[1];
    TRY(sf_catalog_read_header(&cards, t, err));
    return read_rows(&table, t, err);
}

CLEANUP_DEFINE(shear_catalog_table, shear_catalog_table_free)

int shear_catalog_read(shear_catalog_table **table, const char *path, shear_error *err) {
    *table = NULL;
    CLEANUP(shear_catalog_table_release) shear_catalog_table *t = calloc(1, sizeof *t);
    if (t == NULL)
        return sf_fail_memory(err, (sf_place){path, NULL});
    CLEANUP(sf_file_close) sf_file file;
    TRY(sf_file_open(&file, path, -1, err));
    TRY(read_table(&file, t, err));
    *table = CLEANUP_TAKE(t);
    return SHEAR_OK;
}

void shear_catalog_table_free(shear_catalog_table *t) {
    if (t != NULL) {
        free(t->rows);
        free(t);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read result catalogs. */
#include "base/cleanup.h"
#include "fits/catalog/keywords.h"
#include "fits/catalog/schema.h"
#include "fits/header/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Read column `name` as doubles into values[n]; *there is false if the table does not have it. */
static int read_column(const sf_table *table, const char *name, int64_t n, double *values,
                       bool *there, shear_error *err) {
    const sf_column *column = NULL;
    const int rc = sf_table_find_number(table, name, &column, err);
    *there = column != NULL;
    return rc != SHEAR_OK || column == NULL ? rc
                                            : sf_table_doubles(table, column, 0, n, values, err);
}

/* Read a column into a member of all rows; NaN if the table does not have it. */
static int read_member(const sf_table *table, const sf_member *m, double *values,
                       shear_catalog_table *t, shear_error *err) {
    bool there = false;
    const int rc = read_column(table, m->name, t->n, values, &there, err);
    for (int64_t i = 0; rc == SHEAR_OK && i < t->n; i++) {
        const double value = there ? values[i] : NAN;
        memcpy((char *)&t->rows[i] + m->offset, &value, sizeof value);
    }
    return rc;
}

static int read_flags(const sf_table *table, double *values, shear_catalog_table *t,
                      shear_error *err) {
    bool there = false;
    const int rc = read_column(table, "FLAGS", t->n, values, &there, err);
    for (int64_t i = 0; rc == SHEAR_OK && there && i < t->n; i++)
        t->rows[i].flags = values[i] >= 0.0 && values[i] <= UINT32_MAX ? (uint32_t)values[i] : 0u;
    return rc;
}

/* Read a column of pixel coordinates into a member of all rows; -1 if the table does not have
 * it. */
static int read_place(const sf_table *table, const sf_place_member *m, double *values,
                      shear_catalog_table *t, shear_error *err) {
    bool there = false;
    const int rc = read_column(table, m->name, t->n, values, &there, err);
    for (int64_t i = 0; rc == SHEAR_OK && i < t->n; i++) {
        const bool is_one = there && values[i] >= 1.0 && values[i] <= SHEAR_MAX_SIDE;
        const int place = is_one ? (int)values[i] - 1 : -1;
        memcpy((char *)&t->rows[i] + m->offset, &place, sizeof place);
    }
    return rc;
}

/* Set the members without a column to NaN. */
static void forget_members(shear_row *row) {
    row->flux_removed = NAN;
    row->border_mean = NAN;
    row->border_var = NAN;
    row->border_var_noise = NAN;
    row->border_step_x = NAN;
    row->border_step_y = NAN;
    row->border_step2 = NAN;
}

static int read_rows(const sf_table *table, shear_catalog_table *t, shear_error *err) {
    CLEANUP(release_free) double *values = calloc((size_t)t->n + 1, sizeof *values);
    t->rows = calloc((size_t)t->n + 1, sizeof *t->rows);
    if (values == NULL || t->rows == NULL)
        return sf_fail_memory(err, table->cards->at);
    for (int64_t i = 0; i < t->n; i++)
        forget_members(&t->rows[i]);
    int rc = read_flags(table, values, t, err);
    for (int i = 0; rc == SHEAR_OK && i < SF_CATALOG_MEMBERS; i++)
        rc = read_member(table, &sf_catalog_members[i], values, t, err);
    for (int i = 0; rc == SHEAR_OK && i < SF_CATALOG_PLACES; i++)
        rc = read_place(table, &sf_catalog_places[i], values, t, err);
    return rc;
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
    TRY(sf_hdu_index_find(&file->index, SF_CATALOG_HDU, true, &hdu, err));
    if (hdu->kind != SF_TABLE || hdu->zimage || hdu->ztable) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, SF_CATALOG_HDU}, NULL,
                       "must be a plain binary table (BINTABLE)");
    }
    TRY(sf_cards_init(&cards, file, hdu, SF_CATALOG_HDU, err));
    TRY(sf_table_init(&table, file, hdu, &cards, err));
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
    TRY(sf_file_open(&file, path, err));
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

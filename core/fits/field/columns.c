/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/columns.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <assert.h>
#include <stdlib.h>

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

static int check_table(const sf_hdu *hdu, sf_place at, int64_t rows, shear_error *err) {
    if (hdu->ztable || hdu->zimage) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "unpack the file with funpack",
                       "compressed tables are not read");
    }
    if (hdu->kind != SF_TABLE || hdu->naxis != 2)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be a binary table (BINTABLE)");
    if (hdu->axes[1] != rows) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "give it one row a stamp, in stamp order",
                       "it has %lld rows, but there are %lld galaxy stamps",
                       (long long)hdu->axes[1], (long long)rows);
    }
    return SHEAR_OK;
}

int sf_columns_init(sf_columns *c, const sf_part *part, int64_t rows, shear_error *err) {
    *c = (sf_columns){0};
    if (part->hdu == NULL)
        return SHEAR_OK;
    const sf_place at = {part->file->source.name, part->label};
    TRY(check_table(part->hdu, at, rows, err));
    TRY(sf_cards_init(&c->cards, part->file, part->hdu, part->label, err));
    int rc = sf_table_init(&c->table, part->file, part->hdu, &c->cards, err);
    for (int i = 0; rc == SHEAR_OK && i < SF_COLUMNS; i++) {
        rc = sf_table_find_number(&c->table, sf_column_defs[i].name, &c->column[i], err);
        c->have |= rc == SHEAR_OK && c->column[i] != NULL ? sf_column_defs[i].bit : 0u;
    }
    return rc;
}

void sf_columns_deinit(sf_columns *c) {
    sf_table_deinit(&c->table);
    sf_cards_deinit(&c->cards);
    free(c->scratch);
    c->scratch = NULL;
}

static const sf_column *column_of(const sf_columns *c, unsigned bit) {
    assert((c->have & bit) != 0);
    return c->column[__builtin_ctz(bit)];
}

int sf_columns_read_double(sf_columns *c, unsigned bit, int64_t first, int64_t count, double *out,
                           shear_error *err) {
    return sf_table_doubles(&c->table, column_of(c, bit), first, count, out, err);
}

int sf_columns_read_int64(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                          int64_t undefined, int64_t *out, shear_error *err) {
    return sf_table_integers(&c->table, column_of(c, bit), first, count, undefined, out, err);
}

int sf_columns_read_int32(sf_columns *c, unsigned bit, int64_t first, int64_t count,
                          int32_t undefined, int32_t *out, shear_error *err) {
    if (!ARRAY_RESERVE_EXACT(c->scratch, c->capacity, (size_t)count))
        return sf_fail_memory(err, c->cards.at);
    const int rc = sf_columns_read_int64(c, bit, first, count, undefined, c->scratch, err);
    for (int64_t i = 0; rc == SHEAR_OK && i < count; i++) {
        const int64_t v = c->scratch[i];
        out[i] = v > INT32_MAX ? INT32_MAX : v < INT32_MIN ? INT32_MIN : (int32_t)v;
    }
    return rc;
}

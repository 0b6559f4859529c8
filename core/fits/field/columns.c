/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/columns.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <assert.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_table(const sf_hdu *hdu, sf_place at, int64_t rows, shear_error *err) {
    if (hdu->ztable || hdu->zimage) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "unpack the file with funpack",
                       "compressed tables are not read");
    }
    if (hdu->kind != SF_TABLE || hdu->naxis != 2)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be a binary table (BINTABLE)");
    if (hdu->axes[1] != rows) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "give it one row per stamp, in stamp order",
                       "it has %lld rows, but there are %lld galaxy stamps",
                       (long long)hdu->axes[1], (long long)rows);
    }
    return SHEAR_OK;
}

/* Find column `i`; a vector has its length, or up to SHEAR_MAX_PSF_TERMS. */
static int find_column(sf_columns *c, int i, shear_error *err) {
    const sf_column_def *def = &sf_column_defs[i];
    const sf_column **column = &c->column[i];
    if (def->repeat == 1)
        return sf_table_find_number(&c->table, def->name, column, err);
    TRY(sf_table_find_numbers(&c->table, def->name, column, err));
    const int64_t n = *column != NULL ? (*column)->repeat : 1;
    if (*column == NULL || (def->repeat > 0 ? n == def->repeat : n <= SHEAR_MAX_PSF_TERMS))
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, c->cards.at, "correct the column, or rename it",
                   "column %s must hold %s%d numbers per row, but holds %lld", def->name,
                   def->repeat > 0 ? "" : "1 to ",
                   def->repeat > 0 ? def->repeat : (int)SHEAR_MAX_PSF_TERMS, (long long)n);
}

int sf_columns_init(sf_columns *c, const sf_part *part, int64_t rows, shear_error *err) {
    *c = (sf_columns){0};
    if (part->hdu == NULL)
        return SHEAR_OK;
    const sf_place at = {part->file->source.name, part->label};
    TRY(check_table(part->hdu, at, rows, err));
    TRY(sf_cards_init(&c->cards, part->file, part->hdu, part->label, err));
    TRY(sf_table_init(&c->table, &c->cards, err));
    for (int i = 0; i < SF_COLUMNS; i++) {
        TRY(find_column(c, i, err));
        c->have |= c->column[i] != NULL ? sf_column_defs[i].bit : 0u;
    }
    return SHEAR_OK;
}

void sf_columns_deinit(sf_columns *c) {
    sf_table_deinit(&c->table);
    sf_cards_deinit(&c->cards);
    free(c->scratch);
    c->scratch = NULL;
}

static int read_int32(sf_columns *c, const sf_column *column, int64_t first, int64_t count,
                      int64_t undefined, int32_t *out, shear_error *err) {
    if (!ARRAY_RESERVE_EXACT(c->scratch, c->capacity, (size_t)count))
        return sf_fail_memory(err, c->cards.at);
    TRY(sf_table_integers(&c->table, column, first, count, undefined, c->scratch, err));
    for (int64_t i = 0; i < count; i++) {
        const int64_t v = c->scratch[i];
        out[i] = v > INT32_MAX ? INT32_MAX : v < INT32_MIN ? INT32_MIN : (int32_t)v;
    }
    return SHEAR_OK;
}

static int read_vectors(sf_columns *c, const sf_column *column, int64_t first, int64_t count,
                        double *out, shear_error *err) {
    for (int64_t i = 0; i < count; i++)
        TRY(sf_table_cell(&c->table, column, first + i, out + i * column->repeat, err));
    return SHEAR_OK;
}

int sf_columns_read(sf_columns *c, const sf_column_def *def, int64_t first, int64_t count,
                    void *out, shear_error *err) {
    const sf_column *column = c->column[def - sf_column_defs];
    assert(column != NULL);
    if (def->repeat != 1)
        return read_vectors(c, column, first, count, out, err);
    switch (def->form[0]) {
    case 'D':
        return sf_table_doubles(&c->table, column, first, count, out, err);
    case 'K':
        return sf_table_integers(&c->table, column, first, count, def->undefined, out, err);
    default:
        return read_int32(c, column, first, count, def->undefined, out, err);
    }
}

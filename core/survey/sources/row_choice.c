/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/row_choice.h"

#include "base/cleanup.h"
#include "fits/select/expression.h"
#include "fits/select/row_filter.h"

#include <stdlib.h>
#include <string.h>

static int64_t rows_of(const open_table *t) {
    return t->cards.hdu->axes[1];
}

static int64_t chunk_at(const open_table *t, int64_t first) {
    return rows_of(t) - first < ROW_CHUNK ? rows_of(t) - first : ROW_CHUNK;
}

/* ---- selected rows ---- */

static int select_by_flags(uint8_t *marks, const open_table *t, const sf_column *flags,
                           shear_error *err) {
    CLEANUP(release_free) int64_t *value = malloc(ROW_CHUNK * sizeof *value);
    if (value == NULL)
        return sf_fail_memory(err, t->cards.at);
    for (int64_t first = 0; first < rows_of(t); first += ROW_CHUNK) {
        const int64_t n = chunk_at(t, first);
        TRY(sf_table_integers(&t->table, flags, first, n, -1, value, err));
        for (int64_t i = 0; i < n; i++) {
            if (value[i] < 0 || value[i] >= 4)
                marks[first + i] = 0;
        }
    }
    return SHEAR_OK;
}

static int evaluate(uint8_t *marks, const open_table *t, const char *expression, shear_error *err) {
    const sf_column *flags = t->columns.by[SOURCE_FLAGS];
    memset(marks, ROW_SELECTED, (size_t)rows_of(t));
    if (expression != NULL)
        TRY(sf_row_filter(&t->table, expression, marks, err));
    if (flags == NULL || (expression != NULL && sf_expression_names(expression, flags->name)))
        return SHEAR_OK;
    return select_by_flags(marks, t, flags, err);
}

int row_choice_select(row_choice *r, const open_table *t, const char *expression,
                      shear_error *err) {
    if (r->hdu == t->cards.hdu)
        return SHEAR_OK;
    row_choice_deinit(r);
    r->marks = malloc((size_t)rows_of(t) + 1);
    if (r->marks == NULL)
        return sf_fail_memory(err, t->cards.at);
    TRY(evaluate(r->marks, t, expression, err));
    r->hdu = t->cards.hdu;
    return SHEAR_OK;
}

void row_choice_deinit(row_choice *r) {
    free(r->marks);
    *r = (row_choice){0};
}

/* ---- kept rows ---- */

/* Scratch for a chunk of rows. */
typedef struct chunk {
    int64_t extension[ROW_CHUNK];
    double ra[ROW_CHUNK], dec[ROW_CHUNK];
} chunk;

static int read_chunk(chunk *k, open_table *t, int64_t first, int64_t extension, bool places,
                      shear_error *err) {
    t->columns.first = first;
    t->columns.n = chunk_at(t, first);
    if (extension != 0)
        TRY(open_table_extensions(t, first, t->columns.n, k->extension, err));
    if (!places)
        return SHEAR_OK;
    TRY(source_columns_read(&t->columns, SOURCE_RA, k->ra, err));
    return source_columns_read(&t->columns, SOURCE_DEC, k->dec, err);
}

int row_choice_keep(row_choice *r, open_table *t, int64_t extension, source_cap *cap,
                    shear_error *err) {
    const bool places = cap != NULL && t->columns.by[SOURCE_RA] != NULL;
    CLEANUP(release_free) chunk *k = malloc(sizeof *k);
    if (k == NULL)
        return sf_fail_memory(err, t->cards.at);
    r->rows = r->selected = r->kept = 0;
    for (int64_t first = 0; first < rows_of(t); first += ROW_CHUNK) {
        TRY(read_chunk(k, t, first, extension, places, err));
        for (int64_t i = 0; i < t->columns.n; i++) {
            uint8_t *mark = r->marks + first + i;
            const bool own = extension == 0 || k->extension[i] == extension;
            const bool kept = own && (!places || source_cap_sees(cap, k->ra[i], k->dec[i]));
            *mark = (uint8_t)((*mark & ROW_SELECTED) | (kept ? ROW_KEPT : 0));
            r->rows += own;
            r->selected += own && (*mark & ROW_SELECTED) != 0;
            r->kept += kept;
        }
    }
    return SHEAR_OK;
}

bool row_choice_any(const row_choice *r, int64_t first, int64_t n) {
    for (int64_t i = first; i < first + n; i++) {
        if ((r->marks[i] & ROW_KEPT) != 0)
            return true;
    }
    return false;
}

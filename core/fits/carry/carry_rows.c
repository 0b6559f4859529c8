/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/carry/carry_rows.h"

#include "base/cleanup.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

int carry_rows_init(carry_rows *r, const carry_list *l, const sf_table *t, sf_place at,
                    shear_error *err) {
    *r = (carry_rows){.rows = sf_table_rows(t)};
    r->rows.at = at;
    r->pieces = calloc((size_t)l->n + 1, sizeof *r->pieces);
    if (r->pieces == NULL)
        return sf_fail_memory(err, at);
    for (int i = 0; i < l->n; i++) {
        const sf_column *c = carry_list_find(l, i, t);
        carry_piece *last = r->n > 0 ? &r->pieces[r->n - 1] : NULL;
        assert(c != NULL && c->width == l->columns[i].bytes);
        if (last != NULL && last->from + last->bytes == c->offset) {
            last->bytes += c->width;
        } else {
            r->pieces[r->n++] = (carry_piece){c->offset, c->width};
        }
    }
    return SHEAR_OK;
}

void carry_rows_deinit(carry_rows *r) {
    free(r->pieces);
    *r = (carry_rows){0};
}

int carry_rows_read(const carry_rows *r, int64_t row, uint8_t *out, shear_error *err) {
    for (const carry_piece *p = r->pieces; p < r->pieces + r->n; out += p->bytes, p++)
        TRY(sf_rows_bytes(&r->rows, row, p->from, p->bytes, out, err));
    return SHEAR_OK;
}

/* Write a keyword TROOTn whose value is this text of a number, if there is one. */
static void write_number(fitsfile *f, const char *root, int column, const char *value,
                         int *status) {
    char card[FLEN_CARD];
    if (value[0] != '\0') {
        snprintf(card, sizeof card, "%s%-3d= %20s", root, column, value);
        fits_write_record(f, card, status);
    }
}

void carry_write_keys(fitsfile *f, const shear_carried *columns, int n, int first, int *status) {
    for (int i = 0; i < n; i++) {
        write_number(f, "TNULL", first + i, columns[i].null, status);
        write_number(f, "TSCAL", first + i, columns[i].scale, status);
        write_number(f, "TZERO", first + i, columns[i].zero, status);
    }
}

void carry_write_rows(fitsfile *f, int64_t first, int count, const uint8_t *rows, int bytes,
                      int *status) {
    LONGLONG width = 0;
    fits_read_key_lnglng(f, "NAXIS1", &width, NULL, status);
    for (int i = 0; i < count && *status == 0; i++) {
        fits_write_tblbytes(f, first + 1 + i, width - bytes + 1, bytes,
                            (unsigned char *)rows + (size_t)i * (size_t)bytes, status);
    }
}

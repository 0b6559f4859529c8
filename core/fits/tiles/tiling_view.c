/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sf_tiling_show: write the header of a compressed image for CFITSIO. */
#include "fits/tiles/tiling.h"

#include <stdio.h>

static void show_primary(sf_view *v) {
    sf_view_logical(v, "SIMPLE", true);
    sf_view_int(v, "BITPIX", 8);
    sf_view_int(v, "NAXIS", 0);
    sf_view_logical(v, "EXTEND", true);
    sf_view_end(v);
}

static void show_table(const sf_tiling *t, const sf_table *table, sf_view *v) {
    const int64_t rows = table->hdu->axes[0] * table->hdu->axes[1];
    sf_view_string(v, "XTENSION", "BINTABLE");
    sf_view_int(v, "BITPIX", 8);
    sf_view_int(v, "NAXIS", 2);
    sf_view_int(v, "NAXIS1", table->hdu->axes[0]);
    sf_view_int(v, "NAXIS2", table->hdu->axes[1]);
    sf_view_int(v, "PCOUNT", table->hdu->data_bytes - rows);
    sf_view_int(v, "GCOUNT", 1);
    sf_view_int(v, "TFIELDS", table->n);
    sf_view_int(v, "THEAP", t->heap);
}

/* Columns that do not belong to the image are described as characters without a name. */
static void show_column(const sf_tiling *t, const sf_column *c, int i, sf_view *v) {
    char key[SF_INDEXED];
    char form[32];
    snprintf(form, sizeof form, "%lldA", (long long)c->width);
    for (int k = 0; k < SF_TILE_COLUMNS; k++) {
        if (t->column[k] == c) {
            sf_view_string(v, sf_card_indexed(key, "TTYPE", i + 1), sf_tile_columns[k]);
            snprintf(form, sizeof form, "1%c%c", c->type, k <= SF_RAW_DATA ? c->element : '\0');
        }
    }
    sf_view_string(v, sf_card_indexed(key, "TFORM", i + 1), form);
}

static void show_algorithm(const sf_tiling *t, sf_view *v) {
    static const char *const names[] = {"RICE_1", "GZIP_1", "GZIP_2", "PLIO_1", "HCOMPRESS_1"};
    sf_view_string(v, "ZCMPTYPE", names[t->algorithm]);
    if (t->algorithm == SF_RICE) {
        sf_view_int(v, "ZVAL1", t->block);
        sf_view_int(v, "ZVAL2", t->width);
    }
    if (t->algorithm == SF_HCOMPRESS) {
        sf_view_int(v, "ZVAL1", 0);
        sf_view_int(v, "ZVAL2", t->smooth ? 1 : 0);
    }
}

static void show_numbers(const sf_tiling *t, double bscale, double bzero, sf_view *v) {
    static const char *const dithers[] = {"NO_DITHER", "SUBTRACTIVE_DITHER_1",
                                          "SUBTRACTIVE_DITHER_2"};
    if (t->bitpix < 0) {
        sf_view_string(v, "ZQUANTIZ", t->lossless_float ? "NONE" : dithers[t->dither]);
        sf_view_int(v, "ZDITHER0", t->seed);
    }
    if (t->blank != SF_ABSENT)
        sf_view_int(v, "ZBLANK", t->blank);
    if (t->has_scale) {
        sf_view_double(v, "ZSCALE", t->scale);
        sf_view_double(v, "ZZERO", t->zero);
    }
    sf_view_scale(v, bscale, bzero);
}

void sf_tiling_show(const sf_tiling *t, const sf_table *table, double bscale, double bzero,
                    sf_view *view) {
    char key[SF_INDEXED];
    show_primary(view);
    show_table(t, table, view);
    for (int i = 0; i < table->n; i++)
        show_column(t, &table->columns[i], i, view);
    sf_view_logical(view, "ZIMAGE", true);
    sf_view_int(view, "ZBITPIX", t->bitpix);
    sf_view_int(view, "ZNAXIS", t->naxis);
    for (int k = 0; k < t->naxis; k++) {
        sf_view_int(view, sf_card_indexed(key, "ZNAXIS", k + 1), t->axes[k]);
        sf_view_int(view, sf_card_indexed(key, "ZTILE", k + 1), t->tile[k]);
    }
    show_algorithm(t, view);
    show_numbers(t, bscale, bzero, view);
    sf_view_end(view);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/tiling.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/header/header.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* CFITSIO holds a tile, and a row of tiles, in memory as doubles, and numbers tiles with an int, to
 * which it adds ZDITHER0. */
static const int64_t max_tile_pixels = INT64_C(1) << 25;     /* 256 MiB */
static const int64_t max_tile_row_pixels = INT64_C(1) << 27; /* 1 GiB */
static const int64_t max_tiles = INT32_MAX - 10000;

static int bad(const sf_table *t, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, t->cards->at,
                   "unpack the file with funpack, or pack it again with fpack",
                   "tile compression: %s", what);
}

static const char *const tile_columns[SF_TILE_COLUMNS] = {
    "COMPRESSED_DATA", "GZIP_COMPRESSED_DATA", "UNCOMPRESSED_DATA", "ZSCALE", "ZZERO", "ZBLANK"};

/* ---- sizes ---- */

static int read_axis(sf_tiling *t, const sf_table *table, int k, shear_error *err) {
    char key[SF_INDEXED];
    t->axes[k] = t->tile[k] = t->grid[k] = 1;
    if (k >= t->naxis)
        return SHEAR_OK;
    sf_card_indexed(key, "ZNAXIS", k + 1);
    TRY(sf_need_int(table->cards, key, 1, INT32_MAX, &t->axes[k], err));
    t->tile[k] = k == 0 ? t->axes[0] : 1;
    sf_card_indexed(key, "ZTILE", k + 1);
    TRY(sf_key_int(table->cards, key, 1, INT32_MAX, &t->tile[k], err));
    if (t->tile[k] > t->axes[k]) { /* this gives the same tiles */
        t->tile[k] = t->axes[k];
    }
    t->grid[k] = (t->axes[k] - 1) / t->tile[k] + 1;
    return SHEAR_OK;
}

static int check_sizes(const sf_tiling *t, const sf_table *table, shear_error *err) {
    const int64_t rows = table->cards->hdu->axes[1];
    int64_t tiles = 1;
    int64_t pixels = 1;
    for (int k = 0; k < SF_AXES; k++) {
        if (__builtin_mul_overflow(tiles, t->grid[k], &tiles) ||
            __builtin_mul_overflow(pixels, t->tile[k], &pixels) || pixels > max_tile_pixels ||
            tiles > max_tiles) {
            return bad(table, "the tiles (ZTILEn) are larger than 256 MiB or too many", err);
        }
    }
    if (pixels / t->tile[0] * t->axes[0] > max_tile_row_pixels) {
        return bad(table, "a row of tiles (ZNAXIS1 x ZTILE2 x ZTILE3 pixels) is larger than 1 GiB",
                   err);
    }
    return tiles == rows
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, table->cards->at, NULL,
                         "tile compression: ZNAXISn and ZTILEn make %lld tiles, but the table has "
                         "%lld rows",
                         (long long)tiles, (long long)rows);
}

static int read_sizes(sf_tiling *t, const sf_table *table, shear_error *err) {
    TRY(sf_need_int(table->cards, "ZNAXIS", 2, SF_AXES, &t->naxis, err));
    for (int k = 0; k < SF_AXES; k++)
        TRY(read_axis(t, table, k, err));
    return check_sizes(t, table, err);
}

/* ---- algorithm ---- */

static const char *const algorithms[] = {"RICE_1", "RICE_ONE",    "GZIP_1", "GZIP_2",
                                         "PLIO_1", "HCOMPRESS_1", NULL};
static const char *const quantizations[] = {"NO_DITHER", "SUBTRACTIVE_DITHER_1",
                                            "SUBTRACTIVE_DITHER_2", "NONE", NULL};

/* Find a keyword's value in `words`, a list ended by NULL; -1 if the keyword is absent. */
static int read_word(const sf_table *table, const char *key, const char *const *words, int *out,
                     shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    *out = -1;
    TRY(sf_key_string(table->cards, key, &text, err));
    if (text == NULL)
        return SHEAR_OK;
    for (int i = 0; words[i] != NULL; i++) {
        if (strcmp(text, words[i]) == 0) {
            *out = i;
            return SHEAR_OK;
        }
    }
    char all[160];
    char shown[40];
    text_list(all, sizeof all, words);
    sf_printable_name(shown, sizeof shown, text);
    return sf_fail(err, SHEAR_E_FORMAT, table->cards->at, NULL,
                   "tile compression: %s is '%s', but must be one of %s", key, shown, all);
}

static int read_algorithm(sf_tiling *t, const sf_table *table, shear_error *err) {
    int chosen = -1;
    TRY(read_word(table, "ZCMPTYPE", algorithms, &chosen, err));
    if (chosen < 0)
        return bad(table, "ZCMPTYPE is missing", err);
    t->algorithm = chosen == SF_RICE_ONE ? SF_RICE : (enum sf_algorithm)chosen;
    TRY(sf_need_int(table->cards, "ZBITPIX", -64, 64, &t->bitpix, err));
    return sf_bitpix_is_sound(t->bitpix) && t->bitpix != 64
               ? SHEAR_OK
               : bad(table, "ZBITPIX is not one of 8, 16, 32, -32, -64", err);
}

/* Read a parameter, which is identified by its position. If it has a name, it must be the one that
 * belongs there. */
static int read_parameter(const sf_table *table, int i, const char *name, int64_t min, int64_t max,
                          int64_t *value, shear_error *err) {
    char key[SF_INDEXED];
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(table->cards, sf_card_indexed(key, "ZNAME", i), &text, err));
    if (text != NULL && strcmp(text, name) != 0) {
        const bool old = i == 2 && strcmp(text, "NOISEBIT") == 0; /* files from before 2010 */
        return old ? SHEAR_OK
                   : sf_fail(err, SHEAR_E_FORMAT, table->cards->at, NULL,
                             "tile compression: %s is not '%s', which belongs there", key, name);
    }
    return sf_key_int(table->cards, sf_card_indexed(key, "ZVAL", i), min, max, value, err);
}

static int read_rice(sf_tiling *t, const sf_table *table, shear_error *err) {
    t->block = SF_ABSENT;
    TRY(read_parameter(table, 1, "BLOCKSIZE", 16, 32, &t->block, err));
    if (t->block != 16 && t->block != 32)
        return bad(table, "RICE needs ZVAL1 (the block size) 16 or 32", err);
    t->width = 4;
    TRY(read_parameter(table, 2, "BYTEPIX", 1, 4, &t->width, err));
    return t->width == 4 || (t->bitpix > 0 && t->width != 3)
               ? SHEAR_OK
               : bad(table,
                     "RICE needs ZVAL2 (bytes per pixel) 1, 2 or 4, and 4 for floating pixels",
                     err);
}

static int read_hcompress(sf_tiling *t, const sf_table *table, shear_error *err) {
    double scale = NAN; /* ignored: the stream has its own scale */
    int64_t smooth = 0;
    TRY(sf_key_double(table->cards, "ZVAL1", &scale, err));
    if (isnan(scale))
        return bad(table, "HCOMPRESS needs ZVAL1 (the scale)", err);
    TRY(read_parameter(table, 2, "SMOOTH", 0, 1, &smooth, err));
    t->smooth = smooth != 0;
    return t->tile[0] >= 4 && t->tile[1] >= 4 && t->tile[2] == 1
               ? SHEAR_OK
               : bad(table, "HCOMPRESS needs tiles of 4 x 4 pixels at least in one plane", err);
}

/* ---- columns ---- */

static bool is_variable(const sf_column *c, const char *elements) {
    return (c->type == 'P' || c->type == 'Q') && c->repeat == 1 && c->element != '\0' &&
           strchr(elements, c->element) != NULL;
}

/* Return whether the column's cells are plain numbers: not scaled, without a null value. */
static bool is_unscaled(const sf_column *c) {
    return c->by.wrong == NULL && c->by.null_card == NULL && c->by.scale == 1.0 &&
           c->by.zero == 0.0;
}

static int read_columns(sf_tiling *t, const sf_table *table, shear_error *err) {
    const char *const elements[] = {t->algorithm == SF_PLIO ? "I" : "B", "B", "BIJED"};
    for (int i = 0; i < SF_TILE_COLUMNS; i++) {
        TRY(sf_table_find(table, tile_columns[i], &t->column[i], err));
        const sf_column *c = t->column[i];
        if (c == NULL)
            continue;
        const bool sound =
            i <= SF_RAW_DATA
                ? is_variable(c, elements[i])
                : c->repeat == 1 && strchr(i == SF_ZBLANK ? "BIJ" : "ED", c->type) != NULL;
        if (!sound || !is_unscaled(c)) {
            return sf_fail(err, SHEAR_E_FORMAT, table->cards->at, NULL,
                           "tile compression: column %s has the wrong type (TFORM), or TSCAL, "
                           "TZERO or TNULL",
                           tile_columns[i]);
        }
    }
    return t->column[SF_DATA] != NULL ? SHEAR_OK
                                      : bad(table, "there is no column COMPRESSED_DATA", err);
}

static int read_heap(sf_tiling *t, const sf_table *table, shear_error *err) {
    const sf_hdu *hdu = table->cards->hdu;
    const int64_t rows = hdu->axes[0] * hdu->axes[1]; /* within data_bytes, which was checked */
    t->heap = rows;
    return sf_key_int(table->cards, "THEAP", rows, hdu->data_bytes, &t->heap, err);
}

/* ---- how pixels are converted ---- */

/* Floating-point pixels are gzipped as they are, or quantized with a scale and a zero per tile. If
 * both are missing, CFITSIO takes integers for floating-point numbers and reads past their end. */
static int read_quantization(sf_tiling *t, const sf_table *table, shear_error *err) {
    int word = -1;
    TRY(read_word(table, "ZQUANTIZ", quantizations, &word, err));
    t->seed = 1;
    TRY(sf_key_int(table->cards, "ZDITHER0", 1, 10000, &t->seed, err));
    const bool gzip = t->algorithm == SF_GZIP_1 || t->algorithm == SF_GZIP_2;
    const bool scaled = t->column[SF_ZSCALE] != NULL && t->column[SF_ZZERO] != NULL;
    if (word == SF_LOSSLESS && (t->bitpix > 0 || !gzip))
        return bad(table, "ZQUANTIZ 'NONE' needs floating pixels and GZIP", err);
    if ((t->column[SF_ZSCALE] != NULL) != (t->column[SF_ZZERO] != NULL))
        return bad(table, "there is only one of the columns ZSCALE and ZZERO", err);
    t->quantization = word < 0 ? SF_UNDITHERED : (enum sf_quantization)word;
    if (t->bitpix < 0 && gzip && !scaled)
        t->quantization = SF_LOSSLESS;
    return t->bitpix > 0 || scaled || t->quantization == SF_LOSSLESS
               ? SHEAR_OK
               : bad(table, "floating pixels need GZIP, or the columns ZSCALE and ZZERO", err);
}

/* Read the null value, and ZSCALE and ZZERO as keywords, for pixels without such columns. */
static int read_numbers(sf_tiling *t, const sf_table *table, shear_error *err) {
    double scale = NAN;
    double zero = NAN;
    t->blank = SF_ABSENT;
    TRY(sf_key_int(table->cards, "ZBLANK", INT32_MIN, INT32_MAX, &t->blank, err));
    if (t->blank == SF_ABSENT)
        TRY(sf_key_int(table->cards, "BLANK", INT32_MIN, INT32_MAX, &t->blank, err));
    TRY(sf_key_double(table->cards, "ZSCALE", &scale, err));
    TRY(sf_key_double(table->cards, "ZZERO", &zero, err));
    t->has_scale = (!isnan(scale) || !isnan(zero)) && t->column[SF_ZSCALE] == NULL;
    t->scale = isnan(scale) ? 1.0 : scale;
    t->zero = isnan(zero) ? 0.0 : zero;
    return t->scale != 0.0 ? SHEAR_OK : bad(table, "ZSCALE is 0", err);
}

/* Read the parameters of the algorithm. */
static int read_parameters(sf_tiling *t, const sf_table *table, shear_error *err) {
    return t->algorithm == SF_RICE        ? read_rice(t, table, err)
           : t->algorithm == SF_HCOMPRESS ? read_hcompress(t, table, err)
                                          : SHEAR_OK;
}

int sf_tiling_init(sf_tiling *t, const sf_table *table, shear_error *err) {
    static int (*const steps[])(sf_tiling *, const sf_table *, shear_error *) = {
        read_algorithm, read_sizes,        read_parameters, read_columns,
        read_heap,      read_quantization, read_numbers};
    *t = (sf_tiling){.block = 32, .width = 4};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        TRY(steps[i](t, table, err));
    return SHEAR_OK;
}

/* ---- the header for CFITSIO ---- */

/* Columns that do not belong to the image are described as characters without a name. */
static void show_column(const sf_tiling *t, const sf_column *c, int i, sf_view *v) {
    char key[SF_INDEXED];
    char form[32];
    snprintf(form, sizeof form, "%lldA", (long long)c->width);
    for (int k = 0; k < SF_TILE_COLUMNS; k++) {
        if (t->column[k] == c) {
            sf_view_string(v, sf_card_indexed(key, "TTYPE", i + 1), tile_columns[k]);
            snprintf(form, sizeof form, "1%c%c", c->type, k <= SF_RAW_DATA ? c->element : '\0');
        }
    }
    sf_view_string(v, sf_card_indexed(key, "TFORM", i + 1), form);
}

static void show_algorithm(const sf_tiling *t, sf_view *v) {
    sf_view_string(v, "ZCMPTYPE", algorithms[t->algorithm]);
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
    if (t->bitpix < 0) {
        sf_view_string(v, "ZQUANTIZ", quantizations[t->quantization]);
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
    const sf_hdu *hdu = table->cards->hdu;
    sf_view_table(view, hdu, hdu->data_bytes - hdu->axes[0] * hdu->axes[1], table->n);
    sf_view_int(view, "THEAP", t->heap);
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

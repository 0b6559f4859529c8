/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles.h"

#include "fits/tile_stream.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* CFITSIO holds a tile, and a row of tiles, in memory as doubles. */
static const int64_t max_tile_pixels = INT64_C(1) << 25;     /* 256 MiB */
static const int64_t max_tile_row_pixels = INT64_C(1) << 27; /* 1 GiB */

/* A stream longer than this is no compression; it bounds what is read for one tile. */
static int64_t max_stream_bytes(int64_t pixels) {
    return 16 * pixels + 4096;
}

static const struct {
    const char *name;
    int algorithm;
} algorithms[] = {{"RICE_1", SF_RICE}, {"RICE_ONE", SF_RICE}, {"GZIP_1", SF_GZIP},
                  {"GZIP_2", SF_GZIP}, {"PLIO_1", SF_PLIO},   {"HCOMPRESS_1", SF_HCOMPRESS}};

static int algorithm_of(const char *name) {
    for (size_t i = 0; i < sizeof algorithms / sizeof algorithms[0]; i++) {
        if (strcmp(name, algorithms[i].name) == 0) {
            return algorithms[i].algorithm;
        }
    }
    return -1;
}

static int64_t tile_length(const sf_hdu *hdu, int k) {
    if (k >= hdu->znaxis) {
        return 1;
    }
    return hdu->ztile[k] != SF_ABSENT ? hdu->ztile[k] : k == 0 ? hdu->zaxes[0] : 1;
}

static int64_t axis_length(const sf_hdu *hdu, int k) {
    return k < hdu->znaxis ? hdu->zaxes[k] : 1;
}

/* Tiles along axis k, pixels of a whole tile. */
static int64_t tiles_along(const sf_hdu *hdu, int k) {
    return (axis_length(hdu, k) - 1) / tile_length(hdu, k) + 1;
}

static int bad(sf_place at, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, at,
                   "unpack the file with funpack, or pack it anew with fpack",
                   "tile compression: %s", what);
}

static int check_sizes(const sf_hdu *hdu, sf_place at, shear_error *err) {
    if (hdu->znaxis < 2 || hdu->znaxis > SF_AXES) {
        return bad(at, "ZNAXIS is missing or not 2 or 3", err);
    }
    int64_t rows = 1;
    int64_t tile = 1;
    for (int k = 0; k < SF_AXES; k++) {
        if (axis_length(hdu, k) < 1 || tile_length(hdu, k) < 1) {
            return bad(at, "a ZNAXISn or ZTILEn is missing or not positive", err);
        }
        if (__builtin_mul_overflow(rows, tiles_along(hdu, k), &rows) ||
            __builtin_mul_overflow(tile, tile_length(hdu, k), &tile) || tile > max_tile_pixels) {
            return bad(at, "the tiles (ZTILEn) are larger than 256 MiB or too many", err);
        }
    }
    int64_t row_pixels = 0;
    if (__builtin_mul_overflow(axis_length(hdu, 0), tile / tile_length(hdu, 0), &row_pixels) ||
        row_pixels > max_tile_row_pixels) {
        return bad(at, "a row of tiles (NAXIS1 x ZTILE2 x ZTILE3 pixels) is larger than 1 GiB",
                   err);
    }
    if (hdu->naxis != 2 || rows != hdu->axes[1]) {
        return sf_fail(
            err, SHEAR_E_FORMAT, at, NULL,
            "tile compression: ZNAXISn and ZTILEn make %lld tiles, but the table has %lld "
            "rows",
            (long long)rows, (long long)hdu->axes[1]);
    }
    return SHEAR_OK;
}

int sf_tiles_check_header(const sf_hdu *hdu, sf_place at, shear_error *err) {
    const int rc = check_sizes(hdu, at, err);
    if (rc != SHEAR_OK) {
        return rc;
    }
    const int algorithm = algorithm_of(hdu->zcmptype);
    if (algorithm < 0) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL,
                       "tile compression: ZCMPTYPE is '%s', but must be RICE_1, GZIP_1, GZIP_2, "
                       "PLIO_1 or HCOMPRESS_1",
                       hdu->zcmptype);
    }
    const int64_t z = hdu->zbitpix;
    if (z != 8 && z != 16 && z != 32 && z != -32 && z != -64) {
        return bad(at, "ZBITPIX is missing or not one of 8, 16, 32, -32, -64", err);
    }
    if (algorithm == SF_RICE && (hdu->zval[0] < 4 || hdu->zval[0] > 1024)) {
        return bad(at, "RICE needs ZVAL1 (the block size) from 4 to 1024", err);
    }
    const int64_t width = hdu->zval[1] == SF_ABSENT ? 4 : hdu->zval[1];
    if (algorithm == SF_RICE && (width != 4 && (z < 0 || (width != 1 && width != 2)))) {
        return bad(at, "RICE needs ZVAL2 (bytes per pixel) 1, 2 or 4, and 4 for floating pixels",
                   err);
    }
    /* CFITSIO would take the integers for floating numbers, and read past their end. */
    if (strcmp(hdu->zquantiz, "NONE") == 0 && (algorithm != SF_GZIP || z > 0)) {
        return bad(at, "ZQUANTIZ 'NONE' needs floating pixels and GZIP", err);
    }
    return SHEAR_OK;
}

/* A variable-length column of the given element type (0: any number); *col is 0 where there is
 * none. */
static int find_column(const sf_tiles *t, const char *name, int wanted, int *col, int64_t *bytes,
                       shear_error *err) {
    int status = 0;
    char template[FLEN_VALUE];
    snprintf(template, sizeof template, "%s", name);
    *col = 0;
    fits_get_colnum(t->fits, CASEINSEN, template, col, &status);
    if (status == COL_NOT_FOUND) {
        fits_clear_errmsg();
        *col = 0;
        return SHEAR_OK;
    }
    int type = 0;
    long repeat = 0;
    long width = 0;
    fits_get_coltype(t->fits, *col, &type, &repeat, &width, &status);
    if (status != 0) {
        return sf_fail_status(err, t->at, status, "tile compression");
    }
    type = -type; /* CFITSIO's mark of a variable length */
    if (wanted != 0 ? type != wanted
                    : (type != TBYTE && type != TSHORT && type != TLONG && type != TFLOAT &&
                       type != TDOUBLE)) {
        return bad(t->at, "a column of tiles has the wrong type (TFORM)", err);
    }
    *bytes = type == TBYTE ? 1 : type == TSHORT ? 2 : type == TDOUBLE ? 8 : 4;
    return SHEAR_OK;
}

int sf_tiles_init(sf_tiles *t, const sf_file *file, const sf_hdu *hdu, fitsfile *fits, sf_place at,
                  shear_error *err) {
    *t = (sf_tiles){.file = file, .hdu = hdu, .fits = fits, .at = at, .raw_bytes = 1};
    t->algorithm = algorithm_of(hdu->zcmptype);
    t->lossless_float = hdu->zbitpix < 0 && strcmp(hdu->zquantiz, "NONE") == 0;
    for (int k = 0; k < SF_AXES; k++) {
        t->grid[k] = tiles_along(hdu, k);
    }
    const int64_t table = hdu->axes[0] * hdu->axes[1]; /* within data_bytes, which was checked */
    const int64_t heap = hdu->theap == SF_ABSENT ? table : hdu->theap;
    if (heap < table || heap > hdu->data_bytes) {
        return bad(at, "THEAP is out of range", err);
    }
    t->heap_offset = hdu->data_offset + heap;
    t->heap_bytes = hdu->data_bytes - heap;
    int64_t ignored = 0;
    int rc = find_column(t, "COMPRESSED_DATA", t->algorithm == SF_PLIO ? TSHORT : TBYTE,
                         &t->col_data, &ignored, err);
    if (rc == SHEAR_OK) {
        rc = find_column(t, "GZIP_COMPRESSED_DATA", TBYTE, &t->col_gzip, &ignored, err);
    }
    if (rc == SHEAR_OK) {
        rc = find_column(t, "UNCOMPRESSED_DATA", 0, &t->col_raw, &t->raw_bytes, err);
    }
    if (rc == SHEAR_OK && t->col_data == 0) {
        rc = bad(at, "there is no column COMPRESSED_DATA", err);
    }
    if (rc == SHEAR_OK && !sf_bitset_init(&t->sound, hdu->axes[1])) {
        rc = sf_fail_memory(err, at);
    }
    return rc;
}

void sf_tiles_deinit(sf_tiles *t) {
    sf_bitset_deinit(&t->sound);
    free(t->buffer);
    t->buffer = NULL;
}

static int bad_tile(const sf_tiles *t, int64_t tile, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, t->at, "the file is damaged: copy or make it again",
                   "compressed tile %lld: %s", (long long)tile + 1, what);
}

/* Elements and place of one tile in one of the columns; 0 elements where the column is not there.
 */
static int descriptor(const sf_tiles *t, int col, int64_t bytes, int64_t tile, int64_t *count,
                      int64_t *offset, shear_error *err) {
    LONGLONG n = 0;
    LONGLONG at = 0;
    int status = 0;
    if (col > 0) {
        fits_read_descriptll(t->fits, col, tile + 1, &n, &at, &status);
    }
    if (status != 0) {
        return sf_fail_status(err, t->at, status, "a tile's place cannot be read");
    }
    if (n < 0 || at < 0 || at > t->heap_bytes || n > (t->heap_bytes - at) / bytes) {
        return bad_tile(t, tile, "its data lie outside of the HDU", err);
    }
    *count = n;
    *offset = at;
    return SHEAR_OK;
}

static int load(sf_tiles *t, int64_t tile, int64_t pixels, int64_t bytes, int64_t offset,
                shear_error *err) {
    if (bytes > max_stream_bytes(pixels)) {
        return bad_tile(t, tile, "its data are absurdly long", err);
    }
    const int64_t room =
        bytes + (t->algorithm == SF_HCOMPRESS ? 3 * pixels : 0); /* and work space */
    if (room > t->buffer_size) {
        unsigned char *grown = realloc(t->buffer, (size_t)room);
        if (grown == NULL) {
            return sf_fail_memory(err, t->at);
        }
        t->buffer = grown;
        t->buffer_size = room;
    }
    for (int64_t done = 0; done < bytes;) {
        const ssize_t n = pread(t->file->source.fd, t->buffer + done, (size_t)(bytes - done),
                                (off_t)(t->heap_offset + offset + done));
        if (n <= 0) {
            return n < 0 ? sf_fail_errno(err, t->at, errno, "cannot be read")
                         : bad_tile(t, tile, "the file ends before its data do", err);
        }
        done += n;
    }
    return SHEAR_OK;
}

/* Gzipped pixels must be exactly as many bytes as CFITSIO will take them for. */
static bool gzip_sound(const sf_tiles *t, int64_t bytes, int64_t pixels) {
    const int64_t size = sf_gzip_size(t->buffer, bytes, 8 * pixels);
    if (t->lossless_float) { /* doubles also under ZBITPIX -32: CFITSIO tells by the size */
        return size == 4 * pixels || size == 8 * pixels;
    }
    if (t->hdu->zbitpix < 0) { /* quantized to 32-bit integers */
        return size == 4 * pixels;
    }
    return size == pixels || size == 2 * pixels || size == 4 * pixels;
}

static bool stream_sound(const sf_tiles *t, int64_t bytes, int64_t pixels) {
    const sf_hdu *hdu = t->hdu;
    switch (t->algorithm) {
    case SF_RICE:
        return sf_rice_sound(t->buffer, bytes, pixels, hdu->zval[0],
                             hdu->zval[1] == SF_ABSENT ? 4 : hdu->zval[1]);
    case SF_PLIO:
        return sf_plio_sound(t->buffer, bytes);
    case SF_HCOMPRESS:
        return sf_hcompress_sound(t->buffer, bytes, pixels, hdu->zbitpix != 8 && hdu->zbitpix != 16,
                                  t->buffer + bytes);
    default:
        return gzip_sound(t, bytes, pixels);
    }
}

/* A tile that would not compress is in one of two other columns. */
static int check_alternatives(sf_tiles *t, int64_t tile, int64_t pixels, shear_error *err) {
    int64_t count = 0;
    int64_t offset = 0;
    int rc = descriptor(t, t->col_raw, t->raw_bytes, tile, &count, &offset, err);
    if (rc != SHEAR_OK || count > 0) {
        return rc == SHEAR_OK && count != pixels
                   ? bad_tile(t, tile, "it has the wrong number of pixels", err)
                   : rc;
    }
    rc = descriptor(t, t->col_gzip, 1, tile, &count, &offset, err);
    if (rc != SHEAR_OK) {
        return rc;
    }
    if (count == 0) {
        return bad_tile(t, tile, "it has no data", err);
    }
    rc = load(t, tile, pixels, count, offset, err);
    const int64_t wanted = pixels * -t->hdu->zbitpix / 8; /* of floating pixels only */
    if (rc == SHEAR_OK && (wanted < 0 || sf_gzip_size(t->buffer, count, wanted) != wanted)) {
        rc = bad_tile(t, tile, "its gzip data are damaged", err);
    }
    return rc;
}

static int check_tile(sf_tiles *t, int64_t tile, int64_t pixels, shear_error *err) {
    const int64_t element = t->algorithm == SF_PLIO ? 2 : 1;
    int64_t count = 0;
    int64_t offset = 0;
    int rc = descriptor(t, t->col_data, element, tile, &count, &offset, err);
    if (rc != SHEAR_OK) {
        return rc;
    }
    if (count == 0) {
        return check_alternatives(t, tile, pixels, err);
    }
    rc = load(t, tile, pixels, count * element, offset, err);
    if (rc == SHEAR_OK && !stream_sound(t, count * element, pixels)) {
        rc = bad_tile(t, tile, "its data are damaged", err);
    }
    return rc;
}

/* Pixels of the tile at grid position c: those at the far borders are smaller. */
static int64_t tile_pixels(const sf_tiles *t, const int64_t c[SF_AXES]) {
    int64_t pixels = 1;
    for (int k = 0; k < SF_AXES; k++) {
        const int64_t length = tile_length(t->hdu, k);
        const int64_t rest = axis_length(t->hdu, k) - c[k] * length;
        pixels *= rest < length ? rest : length;
    }
    return pixels;
}

int sf_tiles_check(sf_tiles *t, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                   shear_error *err) {
    int64_t lo[SF_AXES];
    int64_t hi[SF_AXES];
    for (int k = 0; k < SF_AXES; k++) {
        lo[k] = first[k] / tile_length(t->hdu, k);
        hi[k] = (first[k] + size[k] - 1) / tile_length(t->hdu, k);
    }
    int64_t c[SF_AXES];
    for (c[2] = lo[2]; c[2] <= hi[2]; c[2]++) {
        for (c[1] = lo[1]; c[1] <= hi[1]; c[1]++) {
            for (c[0] = lo[0]; c[0] <= hi[0]; c[0]++) {
                const int64_t tile = (c[2] * t->grid[1] + c[1]) * t->grid[0] + c[0];
                const int rc = sf_bitset_has(&t->sound, tile)
                                   ? SHEAR_OK
                                   : check_tile(t, tile, tile_pixels(t, c), err);
                if (rc != SHEAR_OK) {
                    return rc;
                }
                sf_bitset_add(&t->sound, tile, 1);
            }
        }
    }
    return SHEAR_OK;
}

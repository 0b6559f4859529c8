/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/tiles.h"

#include "base/array.h"
#include "base/cleanup.h"
#include "base/io.h"
#include "fits/io/bits.h"
#include "fits/tiles/tile_stream.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

int sf_tiles_init(sf_tiles *t, const sf_table *table, const sf_tiling *tiling, shear_error *err) {
    *t = (sf_tiles){.table = table, .tiling = tiling};
    t->heap_offset = table->cards->hdu->data_offset + tiling->heap;
    t->heap_bytes = table->cards->hdu->data_bytes - tiling->heap;
    return sf_bitset_init(&t->sound, table->cards->hdu->axes[1])
               ? SHEAR_OK
               : sf_fail_memory(err, table->cards->at);
}

void sf_tiles_deinit(sf_tiles *t) {
    sf_bitset_deinit(&t->sound);
    free(t->buffer);
    t->buffer = NULL;
}

static int bad_tile(const sf_tiles *t, int64_t tile, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, t->table->cards->at,
                   "the file is damaged: copy or make it again", "compressed tile %lld: %s",
                   (long long)tile + 1, what);
}

static int64_t element_bytes(char type) {
    return type == 'B' ? 1 : type == 'I' ? 2 : type == 'D' ? 8 : 4;
}

/* Read the number of elements and the place of one tile in one of the columns; 0 elements if the
 * column is absent. */
static int descriptor(const sf_tiles *t, int column, int64_t tile, int64_t *count, int64_t *offset,
                      shear_error *err) {
    const sf_column *c = t->tiling->column[column];
    *count = *offset = 0;
    if (c == NULL)
        return SHEAR_OK;
    unsigned char cell[16];
    const int width = c->type == 'Q' ? 8 : 4; /* P: CFITSIO, too, reads these as unsigned */
    TRY(sf_table_bytes(t->table, tile, c->offset, 2 * width, cell, err));
    const uint64_t n = sf_bits_big_endian(cell, width);
    const uint64_t at = sf_bits_big_endian(cell + width, width);
    const uint64_t heap = (uint64_t)t->heap_bytes;
    if (at > heap || n > (heap - at) / (uint64_t)element_bytes(c->element))
        return bad_tile(t, tile, "its data lie outside of the HDU", err);
    *count = (int64_t)n;
    *offset = (int64_t)at;
    return SHEAR_OK;
}

static int load(sf_tiles *t, int64_t tile, int64_t pixels, int64_t bytes, int64_t offset,
                shear_error *err) {
    assert(bytes >= 0 && offset >= 0 && offset <= t->heap_bytes - bytes);
    if (bytes > 16 * pixels + 4096) /* not compression; this bounds the bytes read for one tile */
        return bad_tile(t, tile, "its data are absurdly long", err);
    const int64_t work = t->tiling->algorithm == SF_HCOMPRESS ? 3 * pixels : 0;
    if (!ARRAY_RESERVE_EXACT(t->buffer, t->capacity, (size_t)(bytes + work)))
        return sf_fail_memory(err, t->table->cards->at);
    const ssize_t n = io_read_at(t->table->cards->file->source.fd, t->buffer, (size_t)bytes,
                                 (off_t)(t->heap_offset + offset));
    if (n < 0)
        return sf_fail_errno(err, t->table->cards->at, errno, "cannot be read");
    return n == bytes ? SHEAR_OK : bad_tile(t, tile, "the file ends before its data do", err);
}

/* Gzipped pixels must have exactly as many bytes as CFITSIO will assume. */
static bool gzip_sound(const sf_tiles *t, int64_t bytes, int64_t pixels) {
    const int64_t size = sf_gzip_size(t->buffer, bytes, 8 * pixels);
    if (t->tiling->quantization == SF_LOSSLESS) { /* doubles are possible even if ZBITPIX is -32:
                                                     CFITSIO decides by the size */
        return size == 4 * pixels || size == 8 * pixels;
    }
    if (t->tiling->bitpix < 0) { /* quantized to 32-bit integers */
        return size == 4 * pixels;
    }
    return size == pixels || size == 2 * pixels || size == 4 * pixels;
}

static bool stream_sound(const sf_tiles *t, int64_t bytes, const int64_t sides[SF_AXES]) {
    const sf_tiling *z = t->tiling;
    const int64_t pixels = sides[0] * sides[1] * sides[2];
    switch (z->algorithm) {
    case SF_RICE:
        return sf_rice_sound(t->buffer, bytes, pixels, z->block, z->width);
    case SF_PLIO:
        return sf_plio_sound(t->buffer, bytes, pixels);
    case SF_HCOMPRESS:
        return sf_hcompress_sound(t->buffer, bytes, sides, z->bitpix != 8 && z->bitpix != 16,
                                  t->buffer + bytes);
    default:
        return gzip_sound(t, bytes, pixels);
    }
}

/* Check the other two columns: one of them holds a tile that could not be compressed. */
static int check_alternatives(sf_tiles *t, int64_t tile, int64_t pixels, shear_error *err) {
    int64_t count = 0;
    int64_t offset = 0;
    TRY(descriptor(t, SF_RAW_DATA, tile, &count, &offset, err));
    if (count > 0) {
        return count == pixels ? SHEAR_OK
                               : bad_tile(t, tile, "it has the wrong number of pixels", err);
    }
    TRY(descriptor(t, SF_GZIP_DATA, tile, &count, &offset, err));
    if (count == 0)
        return bad_tile(t, tile, "it has no data", err);
    TRY(load(t, tile, pixels, count, offset, err));
    const int64_t wanted = pixels * -t->tiling->bitpix / 8; /* for floating-point pixels only */
    return wanted >= 0 && sf_gzip_size(t->buffer, count, wanted) == wanted
               ? SHEAR_OK
               : bad_tile(t, tile, "its gzip data are damaged", err);
}

static int check_data(sf_tiles *t, int64_t tile, const int64_t sides[SF_AXES], shear_error *err) {
    const int64_t pixels = sides[0] * sides[1] * sides[2];
    const int64_t element = t->tiling->algorithm == SF_PLIO ? 2 : 1;
    int64_t count = 0;
    int64_t offset = 0;
    TRY(descriptor(t, SF_DATA, tile, &count, &offset, err));
    if (count == 0)
        return check_alternatives(t, tile, pixels, err);
    TRY(load(t, tile, pixels, count * element, offset, err));
    return stream_sound(t, count * element, sides) ? SHEAR_OK
                                                   : bad_tile(t, tile, "its data are damaged", err);
}

static int check_tile(sf_tiles *t, int64_t tile, const int64_t sides[SF_AXES], shear_error *err) {
    if (sf_bitset_has(&t->sound, tile))
        return SHEAR_OK;
    TRY(check_data(t, tile, sides, err));
    sf_bitset_add(&t->sound, tile, 1);
    return SHEAR_OK;
}

/* Compute the sides of the tile at grid position c; those at the far borders are smaller. */
static void tile_sides(const sf_tiling *z, const int64_t c[SF_AXES], int64_t sides[SF_AXES]) {
    for (int k = 0; k < SF_AXES; k++) {
        const int64_t rest = z->axes[k] - c[k] * z->tile[k];
        sides[k] = rest < z->tile[k] ? rest : z->tile[k];
    }
}

int sf_tiles_check(sf_tiles *t, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                   shear_error *err) {
    int64_t lo[SF_AXES];
    int64_t hi[SF_AXES];
    for (int k = 0; k < SF_AXES; k++) {
        lo[k] = first[k] / t->tiling->tile[k];
        hi[k] = (first[k] + size[k] - 1) / t->tiling->tile[k];
    }
    int64_t c[SF_AXES];
    for (c[2] = lo[2]; c[2] <= hi[2]; c[2]++) {
        for (c[1] = lo[1]; c[1] <= hi[1]; c[1]++) {
            for (c[0] = lo[0]; c[0] <= hi[0]; c[0]++) {
                const int64_t tile = (c[2] * t->tiling->grid[1] + c[1]) * t->tiling->grid[0] + c[0];
                int64_t sides[SF_AXES];
                tile_sides(t->tiling, c, sides);
                TRY(check_tile(t, tile, sides, err));
            }
        }
    }
    return SHEAR_OK;
}

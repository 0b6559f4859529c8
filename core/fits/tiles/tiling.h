/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/tiling.h: read and check the keywords and columns of a tile-compressed image. */
#pragma once

#include "fits/header/table.h"
#include "fits/tiles/view.h"

/* The words of ZCMPTYPE and of ZQUANTIZ, in the order of their tables in tiling.c. */
enum sf_algorithm { SF_RICE, SF_RICE_ONE, SF_GZIP_1, SF_GZIP_2, SF_PLIO, SF_HCOMPRESS };
enum sf_quantization { SF_UNDITHERED, SF_DITHER_1, SF_DITHER_2, SF_LOSSLESS };

/* Columns of the table: the tiles' data, and the numbers of each tile. */
enum sf_tile_column { SF_DATA, SF_GZIP_DATA, SF_RAW_DATA, SF_ZSCALE, SF_ZZERO, SF_ZBLANK };
enum { SF_TILE_COLUMNS = 6 };

typedef struct sf_tiling {
    enum sf_algorithm algorithm; /* SF_RICE for its other name, too */
    int64_t bitpix, naxis;
    int64_t axes[SF_AXES], tile[SF_AXES]; /* sides of the image; of a whole tile; 1 beyond naxis */
    int64_t grid[SF_AXES];                /* tiles along each axis */
    enum sf_quantization quantization;    /* of floating-point pixels; lossless: gzipped as such */
    int64_t seed;                         /* ZDITHER0 */
    int64_t block, width;                 /* Rice: pixels per block; bytes per pixel */
    bool smooth;                          /* H-compress: smoothing */
    int64_t blank;                        /* or SF_ABSENT */
    bool has_scale;                       /* ZSCALE and ZZERO are keywords, of integer pixels */
    double scale, zero;
    const sf_column *column[SF_TILE_COLUMNS]; /* NULL: the column is absent */
    int64_t heap;                             /* offset of the heap in the HDU's data */
} sf_tiling;

/* Read the tiling of the HDU of `table`. SHEAR_E_FORMAT names the keyword, its value, and what it
 * must be. */
int sf_tiling_init(sf_tiling *t, const sf_table *table, shear_error *err);

/* Write the headers of a view with this image and nothing else: an empty primary
 * HDU, and the table. `bscale` and `bzero` are the image's. */
void sf_tiling_show(const sf_tiling *t, const sf_table *table, double bscale, double bzero,
                    sf_view *view);

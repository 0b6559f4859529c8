/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/tiles.h: check the tiles of a compressed image before CFITSIO unpacks them. */
#pragma once

#include "fits/io/bitset.h"
#include "fits/tiles/tiling.h"

typedef struct sf_tiles {
    const sf_table *table;
    const sf_tiling *tiling;
    int64_t heap_offset, heap_bytes; /* in the file */
    sf_bitset sound;                 /* tiles that have passed the check */
    unsigned char *buffer;           /* [capacity]: one tile's stream, and work space */
    size_t capacity;
} sf_tiles;

/* Set up. `table` and `tiling` must outlive *t. SHEAR_E_NOMEM. Call sf_tiles_deinit after an error,
 * too. */
int sf_tiles_init(sf_tiles *t, const sf_table *table, const sf_tiling *tiling, shear_error *err);
void sf_tiles_deinit(sf_tiles *t);

/* Check all tiles that touch the box of `size` pixels at `first` (0-based). SHEAR_E_FORMAT names
 * the tile. */
int sf_tiles_check(sf_tiles *t, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                   shear_error *err);

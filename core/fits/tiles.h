/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles.h: the tiles of a compressed image, checked before CFITSIO unpacks them. */
#ifndef SHEAR_FITS_TILES_H
#define SHEAR_FITS_TILES_H

#include "fits/bitset.h"
#include "fits/file.h"

enum sf_algorithm { SF_RICE, SF_GZIP, SF_PLIO, SF_HCOMPRESS };

typedef struct sf_tiles {
    const sf_file *file;
    const sf_hdu *hdu;
    fitsfile *fits; /* at this HDU; the image's */
    sf_place at;
    int algorithm;         /* enum sf_algorithm */
    bool lossless_float;   /* floating pixels gzipped as they are */
    int64_t grid[SF_AXES]; /* tiles along each axis */
    int col_data, col_gzip,
        col_raw;       /* COMPRESSED_DATA and its two alternatives; 0 = no such column */
    int64_t raw_bytes; /* of an element of col_raw */
    int64_t heap_offset, heap_bytes;
    sf_bitset sound;       /* tiles already checked */
    unsigned char *buffer; /* [buffer_size]: one tile's stream, and work space */
    int64_t buffer_size;
} sf_tiles;

/* The header's side: sizes, algorithm and its parameters. Call it before CFITSIO opens the HDU.
 * SHEAR_E_FORMAT. */
int sf_tiles_check_header(const sf_hdu *hdu, sf_place at, shear_error *err);

/* `fits` is the HDU's handle. Deinit it, also after an error. */
int sf_tiles_init(sf_tiles *t, const sf_file *file, const sf_hdu *hdu, fitsfile *fits, sf_place at,
                  shear_error *err);
void sf_tiles_deinit(sf_tiles *t);

/* Check all tiles that touch the box of `size` pixels at `first` (0-based). SHEAR_E_FORMAT names
 * the tile. */
int sf_tiles_check(sf_tiles *t, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                   shear_error *err);

#endif

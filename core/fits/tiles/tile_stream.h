/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/tile_stream.h: is a compressed tile's byte stream sound?
 *
 * CFITSIO's decompressors trust their input: they read past the end of a stream that is too short,
 * and write as many pixels as an H-compress stream says it has. These functions walk through a
 * stream first.
 */
#ifndef SHEAR_FITS_TILES_TILE_STREAM_H
#define SHEAR_FITS_TILES_TILE_STREAM_H

#include <stdbool.h>
#include <stdint.h>

/* Rice: `bytes` hold `pixels` differences in blocks of `block` pixels, each pixel of `pixel_bytes`
 * (1, 2, 4), and nothing else. */
bool sf_rice_sound(const unsigned char *bytes, int64_t count, int64_t pixels, int64_t block,
                   int64_t pixel_bytes);

/* The size that a gzip stream unpacks to; -1 where it is damaged or larger than `limit`. */
int64_t sf_gzip_size(const unsigned char *bytes, int64_t count, int64_t limit);

/* PLIO: `count` bytes of big-endian 16-bit instructions, for `pixels` pixels. */
bool sf_plio_sound(const unsigned char *bytes, int64_t count, int64_t pixels);

/* H-compress (hcompress_stream.c): the stream describes a tile of these sides, and holds all bits
 * that it takes to rebuild it; `wide` allows more than 31 bit planes. `work` has room for 3 bytes a
 * pixel. */
bool sf_hcompress_sound(const unsigned char *bytes, int64_t count, const int64_t sides[3],
                        bool wide, unsigned char *work);

#endif

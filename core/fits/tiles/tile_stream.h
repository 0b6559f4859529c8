/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/tile_stream.h: check that a compressed tile's byte stream is sound.
 *
 * CFITSIO's decompressors trust their input: they read past the end of a stream that is too short,
 * and write as many pixels as an H-compress stream claims to have. These functions follow a stream
 * first, and return false if it is not sound. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* Check a Rice stream: `bytes` must hold `pixels` differences in blocks of `block` pixels, each
 * pixel of `pixel_bytes` (1, 2, 4), and nothing else. */
bool sf_rice_sound(const unsigned char *bytes, int64_t count, int64_t pixels, int64_t block,
                   int64_t pixel_bytes);

/* Return the size that a gzip stream unpacks to; -1 if it is damaged or larger than `limit`. */
int64_t sf_gzip_size(const unsigned char *bytes, int64_t count, int64_t limit);

/* Check a PLIO stream: `count` bytes of big-endian 16-bit instructions, for `pixels` pixels. */
bool sf_plio_sound(const unsigned char *bytes, int64_t count, int64_t pixels);

/* Check an H-compress stream (hcompress_stream.c): it must describe a tile of these sides, and hold
 * all bits needed to rebuild it; `wide` allows more than 31 bit planes. `work` has 3 bytes per
 * pixel. */
bool sf_hcompress_sound(const unsigned char *bytes, int64_t count, const int64_t sides[3],
                        bool wide, unsigned char *work);

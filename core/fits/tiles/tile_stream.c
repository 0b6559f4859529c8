/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/tile_stream.h"

#include "fits/io/bits.h"

#include <zlib.h>

/* Skip one block. A code of `code_bits` bits gives the form of its `pixels` differences: 0: all are
 * zero; the largest code: whole; else the low code-1 bits follow a unary count. */
static bool skip_block(sf_bits *b, int64_t pixels, int code_bits, int whole_code, int pixel_bits) {
    int code = 0;
    if (!sf_bits_read(b, code_bits, &code))
        return false;
    if (code == 0)
        return true;
    if (code == whole_code)
        return sf_bits_skip(b, pixels * pixel_bits);
    for (int64_t i = 0; i < pixels; i++) {
        if (!sf_bits_skip_unary(b) || !sf_bits_skip(b, code - 1))
            return false;
    }
    return true;
}

bool sf_rice_sound(const unsigned char *bytes, int64_t count, int64_t pixels, int64_t block,
                   int64_t pixel_bytes) {
    const int code_bits = pixel_bytes == 4 ? 5 : pixel_bytes == 2 ? 4 : 3;
    const int whole_code = (pixel_bytes == 4 ? 25 : pixel_bytes == 2 ? 14 : 6) + 1;
    const int pixel_bits = (int)(8 * pixel_bytes);
    sf_bits b = {.bytes = bytes, .count = 8 * count};
    if (!sf_bits_skip(&b, pixel_bits)) { /* the first pixel, stored whole */
        return false;
    }
    for (int64_t done = 0; done < pixels; done += block) {
        const int64_t n = pixels - done < block ? pixels - done : block;
        if (!skip_block(&b, n, code_bits, whole_code, pixel_bits))
            return false;
    }
    int rest =
        0; /* zeros that fill the last byte; otherwise it was packed with another block size */
    const int64_t left = b.count - b.position;
    return left < 8 && sf_bits_read(&b, (int)left, &rest) && rest == 0;
}

int64_t sf_gzip_size(const unsigned char *bytes, int64_t count, int64_t limit) {
    unsigned char discard[16384];
    z_stream z = {0};
    if (count > UINT32_MAX || inflateInit2(&z, 15 + 16) != Z_OK)
        return -1;
    z.next_in = (unsigned char *)bytes; /* zlib does not write to it */
    z.avail_in = (uInt)count;
    int64_t size = 0;
    int rc = Z_OK;
    while (rc == Z_OK && size <= limit) {
        z.next_out = discard;
        z.avail_out = sizeof discard;
        rc = inflate(&z, Z_NO_FLUSH);
        size += (int64_t)(sizeof discard - z.avail_out);
    }
    inflateEnd(&z);
    return rc == Z_STREAM_END && size <= limit ? size : -1;
}

static int word(const unsigned char *bytes, int64_t index) {
    return (int16_t)(uint16_t)(bytes[2 * index] << 8 | bytes[2 * index + 1]);
}

bool sf_plio_sound(const unsigned char *bytes, int64_t count, int64_t pixels) {
    const int64_t words = count / 2;
    if (words < 3)
        return false;
    int64_t first = 3;
    int64_t length = word(bytes, 2);
    if (length <= 0) { /* the newer header: its own length, then a data length of two words */
        if (words < 5 || word(bytes, 3) < 0 || word(bytes, 4) < 0)
            return false;
        first = word(bytes, 1);
        length = (int64_t)word(bytes, 4) * 32768 + word(bytes, 3);
    }
    if (first < 0 || length <= 0 || length > words)
        return false;
    int64_t seen = 0;
    for (int64_t i = first; i < length; i++) {
        const int instruction = word(bytes, i) / 4096;
        if (word(bytes, i) < 0)
            return false;
        const bool run = instruction == 0 || instruction == 4 || instruction == 5;
        seen += run ? word(bytes, i) % 4096 : instruction >= 6 ? 1 : 0;
        if (instruction == 1 && ++i >= length) { /* the only instruction with two words */
            return false;
        }
    }
    return seen == pixels;
}

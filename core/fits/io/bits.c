/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/bits.h"

#include <assert.h>

bool sf_bits_skip(sf_bits *b, int64_t n) {
    b->position += n;
    return b->position <= b->count;
}

bool sf_bits_read(sf_bits *b, int n, int *out) {
    assert(n >= 0 && n < 31);
    *out = 0;
    if (n > b->count - b->position)
        return false;
    for (const int64_t end = b->position + n; b->position < end; b->position++)
        *out = 2 * *out + (b->bytes[b->position >> 3] >> (7 - (b->position & 7)) & 1);
    return true;
}

bool sf_bits_skip_unary(sf_bits *b) {
    while (b->position < b->count) {
        const unsigned byte = b->bytes[b->position >> 3] & (0xffu >> (b->position & 7));
        if (byte != 0) {
            b->position = (b->position & ~INT64_C(7)) + (__builtin_clz(byte) - 24) + 1;
            return true;
        }
        b->position = (b->position | 7) + 1;
    }
    return false;
}

uint64_t sf_bits_big_endian(const unsigned char *bytes, int64_t n) {
    assert(n >= 0 && n <= 8);
    uint64_t v = 0;
    for (int64_t i = 0; i < n; i++)
        v = v << 8 | bytes[i];
    return v;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/bits.h: read a stream of bits, most significant first, and never past its end. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct sf_bits {
    const unsigned char *bytes;
    int64_t count;    /* number of bits */
    int64_t position; /* next bit */
} sf_bits;

/* All return false if the stream has fewer bits left. */
bool sf_bits_skip(sf_bits *b, int64_t n);
bool sf_bits_read(sf_bits *b, int n, int *out);
/* Skip zeros and the one that follows them. */
bool sf_bits_skip_unary(sf_bits *b);

/* Return the unsigned number in n bytes, at most 8, most significant byte first. */
uint64_t sf_bits_big_endian(const unsigned char *bytes, int64_t n);

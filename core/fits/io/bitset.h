/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/bitset.h: a set of the numbers 0 to n - 1, such as the rows written so far. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct sf_bitset {
    unsigned char *bytes;
    int64_t size, set; /* bits in all; bits that are set */
} sf_bitset;

bool sf_bitset_init(sf_bitset *b, int64_t size); /* false if out of memory */
void sf_bitset_deinit(sf_bitset *b);
bool sf_bitset_has(const sf_bitset *b, int64_t i);
void sf_bitset_add(sf_bitset *b, int64_t first, int64_t count);
/* Return the first bit that is not set, or -1. */
int64_t sf_bitset_first_gap(const sf_bitset *b);

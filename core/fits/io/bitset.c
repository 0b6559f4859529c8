/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/bitset.h"

#include <assert.h>
#include <stdlib.h>

bool sf_bitset_init(sf_bitset *b, int64_t size) {
    *b = (sf_bitset){.size = size};
    b->bytes = calloc((size_t)(size / 8 + 1), 1);
    return b->bytes != NULL;
}

void sf_bitset_deinit(sf_bitset *b) {
    free(b->bytes);
    *b = (sf_bitset){0};
}

bool sf_bitset_has(const sf_bitset *b, int64_t i) {
    assert(i >= 0 && i < b->size);
    return (b->bytes[i / 8] >> (i % 8) & 1) != 0;
}

void sf_bitset_add(sf_bitset *b, int64_t first, int64_t count) {
    for (int64_t i = first; i < first + count; i++) {
        if (!sf_bitset_has(b, i)) {
            b->bytes[i / 8] = (unsigned char)(b->bytes[i / 8] | 1u << (i % 8));
            b->set++;
        }
    }
}

int64_t sf_bitset_first_gap(const sf_bitset *b) {
    for (int64_t i = 0; b->set < b->size && i < b->size; i++) {
        if (!sf_bitset_has(b, i))
            return i;
    }
    return -1;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mutations of FITS files in libFuzzer's runs. */
#include "cards.h"
#include "fuzz_field.h"

/* libFuzzer's own mutations, and as often those that know what a card is. */
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    uint64_t state = seed;
    if (fuzz_below(&state, 2) == 0)
        return LLVMFuzzerMutate(data, size, max_size);
    for (size_t n = 1 + fuzz_below(&state, 3); n > 0; n--)
        fuzz_mutate_card(data, size, &state);
    return size;
}

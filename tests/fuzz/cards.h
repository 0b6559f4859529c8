/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cards.h: mutations of header cards. */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { FUZZ_CARD = 80, FUZZ_BLOCK = 2880 };

/* What a card's value is changed to: numbers at their limits, words that CFITSIO knows. */
extern const char *const fuzz_values[];
extern const int fuzz_n_values;
/* Give the card the value; "" leaves it without one. */
void fuzz_set_value(uint8_t *card, const char *value);

/* Does a card of a header begin here? (Headers begin at blocks of 2880 bytes.) */
int fuzz_is_card(const uint8_t *at);

/* splitmix64 */
uint64_t fuzz_draw(uint64_t *state);
size_t fuzz_below(uint64_t *state, size_t n);

/* Change, double, swap or remove one card. */
void fuzz_mutate_card(uint8_t *data, size_t size, uint64_t *state);

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cards.h"

#include <stdio.h>
#include <string.h>

/* clang-format off */
const char *const fuzz_values[] = {
    "0", "1", "-1", "2", "3", "4", "5", "7", "8", "9", "10", "13", "16", "31", "32", "64", "-32", "-64",
    "100", "255", "256", "1000", "1024", "10000", "10001", "32767", "65535", "100000000", "2147483647",
    "2147483648", "-2147483648", "-2147483649", "4294967296", "9223372036854775807",
    "9223372036854775808", "-9223372036854775808", "100000000000000000000000000000",
    "0.5", "-1.5", "1E308", "1E999", "1E-320", "NaN", "T", "F", "", "'", "/", "(1,2)",
    "''", "'NONE'", "'RICE_1'", "'GZIP_1'", "'GZIP_2'", "'PLIO_1'", "'HCOMPRESS_1'", "'NOCOMPRESS'",
    "'SUBTRACTIVE_DITHER_1'", "'SUBTRACTIVE_DITHER_2'", "'NO_DITHER'", "'BYTEPIX'", "'NOISEBIT'",
    "'1PB'", "'1QB(9)'", "'1PI(99)'", "'1QD'", "'D'", "'2D'", "'1000000000D'", "'99999999999999999999A'",
    "'IMAGE'", "'BINTABLE'", "'TABLE'", "'GALAXY'", "'PSF'", "'COMPRESSED_DATA'", "'ZSCALE'",
    "'a string of many more characters than thirty, in which there is no number'"};
static const char *const keywords[] = {
    "BITPIX", "NAXIS", "NAXIS1", "NAXIS2", "NAXIS3", "PCOUNT", "GCOUNT", "TFIELDS", "THEAP", "EXTNAME", "XTENSION",
    "ZIMAGE", "ZTABLE", "ZCMPTYPE", "ZBITPIX", "ZNAXIS", "ZNAXIS1", "ZNAXIS2", "ZNAXIS3", "ZTILE1", "ZTILE2", "ZTILE3",
    "ZNAME1", "ZNAME2", "ZVAL1", "ZVAL2", "ZQUANTIZ", "ZDITHER0", "ZBLANK", "BLANK", "ZSCALE", "ZZERO", "BSCALE",
    "BZERO", "TTYPE1", "TTYPE2", "TFORM1", "TFORM2", "TFORM3", "TNULL1", "TSCAL1", "TZERO1", "TDIM1", "TDISP1",
    "GROUPS", "END", "CONTINUE", "HIERARCH", "STAMPNX", "STAMPNY", "NSTAMP", "OVERSAMP", "FIELD", "PIXSCALE",
    "SIM_G1", "SIM_G2"};
/* clang-format on */
const int fuzz_n_values = sizeof fuzz_values / sizeof fuzz_values[0];

uint64_t fuzz_draw(uint64_t *state) {
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

size_t fuzz_below(uint64_t *state, size_t n) {
    return n == 0 ? 0 : (size_t)(fuzz_draw(state) % n);
}

int fuzz_is_card(const uint8_t *at) {
    return at[0] >= 'A' && at[0] <= 'Z' && at[8] == '=' && at[9] == ' ';
}

void fuzz_set_value(uint8_t *card, const char *value) {
    char text[FUZZ_CARD + 1];
    snprintf(text, sizeof text, "= %-70.70s", value);
    memcpy(card + 8, text, FUZZ_CARD - 8);
}

/* Some header's card; NULL where none is found. They lie at multiples of 80. */
static uint8_t *any_card(uint8_t *data, size_t size, uint64_t *state) {
    for (int tries = 0; size >= FUZZ_CARD && tries < 1000; tries++) {
        uint8_t *card = data + fuzz_below(state, size / FUZZ_CARD) * FUZZ_CARD;
        if (fuzz_is_card(card) != 0)
            return card;
    }
    return NULL;
}

static void swap(uint8_t *a, uint8_t *b, size_t n) {
    uint8_t kept[FUZZ_CARD];
    memcpy(kept, a, n);
    memmove(a, b, n);
    memcpy(b, kept, n);
}

void fuzz_mutate_card(uint8_t *data, size_t size, uint64_t *state) {
    enum { KEYWORDS = sizeof keywords / sizeof keywords[0], KEY = 8 };
    uint8_t *card = any_card(data, size, state);
    uint8_t *other = any_card(data, size, state);
    char key[KEY + 1];
    if (card == NULL || other == NULL)
        return;
    switch (fuzz_below(state, 8)) {
    case 0: /* twice there */
        memmove(card, other, FUZZ_CARD);
        break;
    case 1: /* another one's name */
        memmove(card, other, KEY);
        break;
    case 2:
        swap(card, other, FUZZ_CARD);
        break;
    case 3: /* gone */
        memset(card, ' ', FUZZ_CARD);
        break;
    case 4: /* a keyword that CFITSIO acts on */
        snprintf(key, sizeof key, "%-8s", keywords[fuzz_below(state, KEYWORDS)]);
        memcpy(card, key, KEY);
        break;
    default:
        fuzz_set_value(card, fuzz_values[fuzz_below(state, (size_t)fuzz_n_values)]);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/header.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/header/card.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

enum scalar_type { INTEGER, LOGICAL, STRING };

#define HDU(member) (offsetof(sf_header, hdu) + offsetof(sf_hdu, member))

/* The keywords that decide where the HDU ends and what it is. All others are checked when the HDU
 * is read. */
static const struct {
    const char *key;
    enum scalar_type type;
    size_t offset; /* in sf_header */
} scalars[] = {
    {"BITPIX", INTEGER, HDU(bitpix)},  {"NAXIS", INTEGER, HDU(naxis)},
    {"NAXIS1", INTEGER, HDU(axes[0])}, {"NAXIS2", INTEGER, HDU(axes[1])},
    {"NAXIS3", INTEGER, HDU(axes[2])}, {"PCOUNT", INTEGER, HDU(pcount)},
    {"GCOUNT", INTEGER, HDU(gcount)},  {"ZIMAGE", LOGICAL, HDU(zimage)},
    {"ZTABLE", LOGICAL, HDU(ztable)},  {"GROUPS", LOGICAL, offsetof(sf_header, groups)},
    {"EXTNAME", STRING, HDU(name)},    {"XTENSION", STRING, offsetof(sf_header, xtension)},
};

enum { N_SCALARS = sizeof scalars / sizeof scalars[0] };

void sf_header_init(sf_header *h, int number, const char *file) {
    *h = (sf_header){.hdu = {.number = number,
                             .bitpix = SF_ABSENT,
                             .naxis = SF_ABSENT,
                             .axes = {1, 1, 1},
                             .gcount = 1},
                     .file = file,
                     .further_axes = 1};
    if (number == 0) {
        text_set(h->label, SF_NAME, "primary");
    } else {
        snprintf(h->label, SF_NAME, "%d (from 0)", number);
    }
}

static int bad(const sf_header *h, const char *key, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){h->file, h->label}, NULL, "keyword %s %s", key,
                   what);
}

/* Find EXTNAME in a block of cards, before they are parsed one by one. */
static void find_label(sf_header *h, const char *block) {
    for (int i = 0; i < SF_BLOCK_BYTES && !h->named; i += SF_CARD) {
        char name[SF_NAME];
        h->named = memcmp(block + i, "EXTNAME ", SF_KEY) == 0 &&
                   sf_card_string(block + i, name, sizeof name) && name[0] != '\0';
        if (h->named) {
            sf_make_printable(name);
            text_set(h->label, SF_NAME, name);
        }
    }
}

static int parse_integer(const sf_header *h, const char *card, const char *key, int64_t *out,
                         shear_error *err) {
    return sf_card_int(card, out) ? SHEAR_OK
                                  : bad(h, key, "is not an integer (of up to 64 bits)", err);
}

/* Old versions of fpack write an EXTNAME of their own before that of the image. */
static bool is_packers_name(const sf_header *h, const char *member) {
    return member == h->hdu.name && h->hdu.zimage && strcmp(member, "COMPRESSED_IMAGE") == 0;
}

static int parse_scalar(sf_header *h, int i, const char *card, shear_error *err) {
    const char *key = scalars[i].key;
    char *member = (char *)h + scalars[i].offset;
    if ((h->seen & 1u << i) != 0 && !is_packers_name(h, member))
        return bad(h, key, "is given twice", err);
    h->seen |= 1u << i;
    switch (scalars[i].type) {
    case INTEGER:
        return parse_integer(h, card, key, (int64_t *)(void *)member, err);
    case LOGICAL:
        return sf_card_logical(card, (bool *)member)
                   ? SHEAR_OK
                   : bad(h, key, "is not a logical (T or F)", err);
    default:
        if (!sf_card_string(card, member, SF_NAME))
            return bad(h, key, "is not a string", err);
        sf_make_printable(member);
        return SHEAR_OK;
    }
}

/* Multiply the sides of the axes that no field file has. */
static int parse_further_axis(sf_header *h, const char *card, const char *key, shear_error *err) {
    int64_t value = 0;
    TRY(parse_integer(h, card, key, &value, err));
    if (h->further_axes >= 0 &&
        (value < 0 || __builtin_mul_overflow(h->further_axes, value, &h->further_axes))) {
        h->further_axes = -1;
    }
    return SHEAR_OK;
}

static enum sf_kind kind_of(const sf_header *h) {
    if (h->hdu.number == 0 || strcmp(h->xtension, "IMAGE") == 0)
        return SF_IMAGE;
    return strcmp(h->xtension, "BINTABLE") == 0 ? SF_TABLE : SF_OTHER;
}

/* Return the keyword that FITS requires as the next card, perhaps in `key`; NULL if any is
 * allowed. */
static const char *wanted_key(const sf_header *h, char key[SF_INDEXED]) {
    static const char *const first[] = {NULL, "BITPIX", "NAXIS"};
    static const char *const of_table[] = {"PCOUNT", "GCOUNT", "TFIELDS"};
    const int n = h->cards;
    if (n < 3)
        return first[n];
    if (n - 2 <= h->hdu.naxis)
        return sf_card_indexed(key, "NAXIS", n - 2);
    return n >= 5 && n <= 7 && kind_of(h) == SF_TABLE ? of_table[n - 5] : NULL;
}

static int check_order(const sf_header *h, const char *key, shear_error *err) {
    char numbered[SF_INDEXED];
    const char *wanted = wanted_key(h, numbered);
    if (wanted == NULL || strcmp(key, wanted) == 0)
        return SHEAR_OK;
    char what[64];
    snprintf(what, sizeof what, "must be card %d of the header", h->cards + 1);
    return bad(h, wanted, what, err);
}

static int parse_card(sf_header *h, const char *card, const char *key, shear_error *err) {
    TRY(check_order(h, key, err));
    h->cards++;
    const int axis = sf_card_index(key, "NAXIS");
    h->axes_seen += axis > 0 ? 1 : 0;
    for (int i = 0; i < N_SCALARS; i++) {
        if (strcmp(key, scalars[i].key) == 0)
            return parse_scalar(h, i, card, err);
    }
    return axis > 0 ? parse_further_axis(h, card, key, err) : SHEAR_OK;
}

int sf_header_block(sf_header *h, const char *block, shear_error *err) {
    find_label(h, block);
    for (int i = 0; i < SF_BLOCK_BYTES; i += SF_CARD) {
        char key[SF_KEY + 1];
        sf_card_key(block + i, key);
        h->ended = strcmp(key, "END") == 0;
        if (h->ended)
            break;
        TRY(parse_card(h, block + i, key, err));
    }
    return SHEAR_OK;
}

bool sf_bitpix_is_sound(int64_t bitpix) {
    return bitpix == 8 || bitpix == 16 || bitpix == 32 || bitpix == 64 || bitpix == -32 ||
           bitpix == -64;
}

/* Compute |BITPIX|/8 GCOUNT (PCOUNT + product of the axes). Return false on overflow. */
static bool data_bytes(const sf_header *h, int64_t *out) {
    const sf_hdu *hdu = &h->hdu;
    const int64_t pixel_bytes = (hdu->bitpix < 0 ? -hdu->bitpix : hdu->bitpix) / 8;
    int64_t n = hdu->naxis > 0 ? h->further_axes : 0;
    for (int k = 0; k < SF_AXES; k++) {
        if (__builtin_mul_overflow(n, hdu->axes[k], &n))
            return false;
    }
    if (__builtin_add_overflow(n, hdu->pcount, &n) || __builtin_mul_overflow(n, hdu->gcount, &n) ||
        __builtin_mul_overflow(n, pixel_bytes, out)) {
        return false;
    }
    return *out <= INT64_MAX - SF_BLOCK_BYTES; /* leave space for the padding of the last block */
}

static int check_axes(const sf_header *h, shear_error *err) {
    const sf_hdu *hdu = &h->hdu;
    if (hdu->naxis < 0 || hdu->naxis > 999)
        return bad(h, "NAXIS", hdu->naxis == SF_ABSENT ? "is missing" : "is not 0 to 999", err);
    if (h->axes_seen != hdu->naxis)
        return bad(h, "NAXIS", "does not agree with the number of NAXISn keywords", err);
    for (int k = 0; k < SF_AXES; k++) {
        char key[SF_INDEXED];
        if (hdu->axes[k] < 0)
            return bad(h, sf_card_indexed(key, "NAXIS", k + 1), "is negative", err);
    }
    return SHEAR_OK;
}

int sf_header_end(sf_header *h, shear_error *err) {
    sf_hdu *hdu = &h->hdu;
    hdu->kind = kind_of(h);
    if (!sf_bitpix_is_sound(hdu->bitpix))
        return bad(h, "BITPIX", "is missing or not one of 8, 16, 32, 64, -32, -64", err);
    TRY(check_axes(h, err));
    if (h->groups)
        return bad(h, "GROUPS", "announces random groups, which field files do not have", err);
    if (hdu->pcount < 0 || hdu->gcount < 1)
        return bad(h, hdu->pcount < 0 ? "PCOUNT" : "GCOUNT", "is out of range", err);
    if (!data_bytes(h, &hdu->data_bytes))
        return bad(h, "NAXIS", "and NAXISn: the data's size does not fit 64 bits", err);
    return SHEAR_OK;
}

uint64_t sf_header_hash(uint64_t before, const char *block) {
    return XXH3_64bits_withSeed(block, SF_BLOCK_BYTES, before);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/header.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/header/card.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum scalar_type { INTEGER, LOGICAL, STRING };

#define HDU(member) (offsetof(sf_header, hdu) + offsetof(sf_hdu, member))

/* The keywords that decide where the HDU ends and what it is. All others are checked when the HDU
 * is read. */
static const struct {
    const char *key;
    enum scalar_type type;
    size_t offset; /* in sf_header */
} scalars[] = {
    {"BITPIX", INTEGER, HDU(bitpix)},
    {"NAXIS", INTEGER, HDU(naxis)},
    {"PCOUNT", INTEGER, HDU(pcount)},
    {"GCOUNT", INTEGER, HDU(gcount)},
    {"ZIMAGE", LOGICAL, HDU(zimage)},
    {"ZTABLE", LOGICAL, HDU(ztable)},
    {"GROUPS", LOGICAL, offsetof(sf_header, groups)},
    {"EXTNAME", STRING, HDU(name)},
    {"XTENSION", STRING, offsetof(sf_header, xtension)},
};

enum { N_SCALARS = sizeof scalars / sizeof scalars[0] };

static int64_t *integer_at(sf_header *h, size_t offset) {
    return (int64_t *)(void *)((char *)h + offset);
}

void sf_header_init(sf_header *h, int number) {
    *h = (sf_header){.hdu.number = number, .further_axes = 1};
    for (int i = 0; i < N_SCALARS; i++) {
        if (scalars[i].type == INTEGER)
            *integer_at(h, scalars[i].offset) = SF_ABSENT;
    }
    for (int k = 0; k < SF_AXES; k++)
        h->hdu.axes[k] = SF_ABSENT;
}

const char *sf_header_label(const sf_header *h, char out[SF_NAME]) {
    if (h->label[0] != '\0') {
        text_set(out, SF_NAME, h->label);
    } else if (h->hdu.number == 0) {
        snprintf(out, SF_NAME, "primary");
    } else {
        snprintf(out, SF_NAME, "%d (from 0)", h->hdu.number);
    }
    return out;
}

static int bad(const sf_header *h, const char *file, const char *key, const char *what,
               shear_error *err) {
    char label[SF_NAME];
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file, sf_header_label(h, label)}, NULL,
                   "keyword %s %s", key, what);
}

static int parse_integer(sf_header *h, const char *card, const char *key, int64_t *out,
                         const char *file, shear_error *err) {
    if (*out != SF_ABSENT)
        return bad(h, file, key, "is given twice", err);
    if (!sf_card_int(card, out)) {
        *out = SF_ABSENT;
        return bad(h, file, key, "is not an integer (of up to 64 bits)", err);
    }
    return SHEAR_OK;
}

static void printable(char *text) {
    for (char *c = text; *c != '\0'; c++) {
        if (*c < ' ' || *c > '~')
            *c = '?';
    }
}

void sf_header_find_label(sf_header *h, const char *block) {
    for (int i = 0; i < SF_BLOCK_BYTES && h->label[0] == '\0'; i += SF_CARD) {
        char key[SF_KEY + 1];
        sf_card_key(block + i, key);
        if (strcmp(key, "EXTNAME") == 0 && sf_card_string(block + i, h->label, SF_NAME))
            printable(h->label);
    }
}

static int parse_scalar(sf_header *h, int i, const char *card, const char *file, shear_error *err) {
    char *member = (char *)h + scalars[i].offset;
    if ((h->seen & 1u << i) != 0)
        return bad(h, file, scalars[i].key, "is given twice", err);
    h->seen |= 1u << i;
    if (scalars[i].type == INTEGER)
        return parse_integer(h, card, scalars[i].key, integer_at(h, scalars[i].offset), file, err);
    if (scalars[i].type == LOGICAL) {
        return sf_card_logical(card, (bool *)member)
                   ? SHEAR_OK
                   : bad(h, file, scalars[i].key, "is not a logical (T or F)", err);
    }
    if (!sf_card_string(card, member, SF_NAME))
        return bad(h, file, scalars[i].key, "is not a string", err);
    printable(member);
    return SHEAR_OK;
}

static int parse_axis(sf_header *h, const char *card, const char *key, int index, const char *file,
                      shear_error *err) {
    h->axes_seen++;
    if (index <= SF_AXES)
        return parse_integer(h, card, key, &h->hdu.axes[index - 1], file, err);
    int64_t value = SF_ABSENT;
    TRY(parse_integer(h, card, key, &value, file, err));
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

/* Set `key` to the keyword that FITS requires as the next card; "" if any is allowed. */
static void wanted_key(const sf_header *h, char key[24]) {
    static const char *const table[] = {"PCOUNT", "GCOUNT", "TFIELDS"};
    const int n = h->cards;
    key[0] = '\0';
    if (n == 1 || n == 2) {
        text_set(key, 24, n == 1 ? "BITPIX" : "NAXIS");
    } else if (n >= 3 && n - 2 <= h->hdu.naxis) {
        snprintf(key, 24, "NAXIS%d", n - 2);
    } else if (n == 5 || n == 6 || n == 7) {
        text_set(key, 24, kind_of(h) == SF_TABLE ? table[n - 5] : "");
    }
}

static int check_order(const sf_header *h, const char *key, const char *file, shear_error *err) {
    char wanted[24];
    wanted_key(h, wanted);
    if (wanted[0] == '\0' || strcmp(key, wanted) == 0)
        return SHEAR_OK;
    char what[64];
    snprintf(what, sizeof what, "must be card %d of the header", h->cards + 1);
    return bad(h, file, wanted, what, err);
}

int sf_header_card(sf_header *h, const char *card, const char *file, shear_error *err) {
    char key[SF_KEY + 1];
    sf_card_key(card, key);
    const int rc = check_order(h, key, file, err);
    h->cards++;
    if (rc != SHEAR_OK)
        return rc;
    for (int i = 0; i < N_SCALARS; i++) {
        if (strcmp(key, scalars[i].key) == 0)
            return parse_scalar(h, i, card, file, err);
    }
    const int index = sf_card_index(key, "NAXIS");
    return index > 0 ? parse_axis(h, card, key, index, file, err) : SHEAR_OK;
}

static bool bitpix_ok(int64_t bitpix) {
    return bitpix == 8 || bitpix == 16 || bitpix == 32 || bitpix == 64 || bitpix == -32 ||
           bitpix == -64;
}

/* Compute |BITPIX|/8 GCOUNT (PCOUNT + product of the axes). Return false on overflow. */
static bool data_bytes(const sf_header *h, int64_t *out) {
    const sf_hdu *hdu = &h->hdu;
    const int64_t pixel_bytes = (hdu->bitpix < 0 ? -hdu->bitpix : hdu->bitpix) / 8;
    int64_t n = hdu->naxis > 0 ? h->further_axes : 0;
    for (int k = 0; k < SF_AXES && k < hdu->naxis; k++) {
        if (__builtin_mul_overflow(n, hdu->axes[k], &n))
            return false;
    }
    if (__builtin_add_overflow(n, hdu->pcount, &n))
        return false;
    if (__builtin_mul_overflow(n, hdu->gcount, &n))
        return false;
    if (__builtin_mul_overflow(n, pixel_bytes, out))
        return false;
    return *out <= INT64_MAX - SF_BLOCK_BYTES; /* leave space for the padding of the last block */
}

static int check_axes(sf_header *h, const char *file, shear_error *err) {
    sf_hdu *hdu = &h->hdu;
    if (hdu->naxis < 0 || hdu->naxis > 999) {
        return bad(h, file, "NAXIS", hdu->naxis == SF_ABSENT ? "is missing" : "is not 0 to 999",
                   err);
    }
    if (h->axes_seen != hdu->naxis)
        return bad(h, file, "NAXIS", "does not agree with the number of NAXISn keywords", err);
    for (int k = 0; k < SF_AXES; k++) {
        char key[24];
        snprintf(key, sizeof key, "NAXIS%d", k + 1);
        if (k >= hdu->naxis) {
            hdu->axes[k] = 1;
        } else if (hdu->axes[k] < 0) {
            return bad(h, file, key, hdu->axes[k] == SF_ABSENT ? "is missing" : "is negative", err);
        }
    }
    return SHEAR_OK;
}

int sf_header_end(sf_header *h, const char *file, shear_error *err) {
    sf_hdu *hdu = &h->hdu;
    hdu->kind = kind_of(h);
    if (!bitpix_ok(hdu->bitpix))
        return bad(h, file, "BITPIX", "is missing or not one of 8, 16, 32, 64, -32, -64", err);
    TRY(check_axes(h, file, err));
    hdu->pcount = hdu->pcount == SF_ABSENT ? 0 : hdu->pcount;
    hdu->gcount = hdu->gcount == SF_ABSENT ? 1 : hdu->gcount;
    if (h->groups) {
        return bad(h, file, "GROUPS", "announces random groups, which field files do not have",
                   err);
    }
    if (hdu->pcount < 0 || hdu->gcount < 1)
        return bad(h, file, hdu->pcount < 0 ? "PCOUNT" : "GCOUNT", "is out of range", err);
    if (!data_bytes(h, &hdu->data_bytes))
        return bad(h, file, "NAXIS", "and NAXISn: the data's size does not fit 64 bits", err);
    return SHEAR_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/cards.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "fits/header/header.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int64_t count_cards(const char *text, int64_t bytes) {
    char key[SF_KEY + 1];
    int64_t n = 0;
    for (; (n + 1) * SF_CARD <= bytes; n++) {
        sf_card_key(text + n * SF_CARD, key);
        if (strcmp(key, "END") == 0)
            break;
    }
    return n;
}

static uint64_t hash_of(const char *text, int64_t bytes) {
    uint64_t hash = 0;
    for (int64_t at = 0; at < bytes; at += SF_BLOCK_BYTES)
        hash = sf_header_hash(hash, text + at);
    return hash;
}

int sf_cards_init(sf_cards *c, const sf_file *file, const sf_hdu *hdu, const char *label,
                  shear_error *err) {
    const int64_t bytes = hdu->header_bytes;
    *c = (sf_cards){.file = file,
                    .hdu = hdu,
                    .at = {file->source.name, label},
                    .text = calloc(1, (size_t)bytes)};
    if (c->text == NULL)
        return sf_fail_memory(err, c->at);
    if (io_read_at(file->source.fd, c->text, (size_t)bytes, (off_t)hdu->header_offset) < 0)
        return sf_fail_errno(err, c->at, errno, "its header cannot be read");
    if (hash_of(c->text, bytes) != hdu->header_hash) {
        return sf_fail(err, SHEAR_E_FORMAT, c->at, "leave a file alone while it is read",
                       "its header has changed since the file was opened");
    }
    c->count = count_cards(c->text, bytes);
    return SHEAR_OK;
}

void sf_cards_deinit(sf_cards *c) {
    free(c->text);
    c->text = NULL;
    c->count = 0;
}

int sf_cards_find(const sf_cards *c, const char *key, const char **card, shear_error *err) {
    char padded[SF_KEY + 1];
    snprintf(padded, sizeof padded, "%-8s", key);
    *card = NULL;
    for (int64_t i = 0; i < c->count; i++) {
        const char *here = c->text + i * SF_CARD;
        if (memcmp(here, padded, SF_KEY) != 0 || !sf_card_has_value(here))
            continue;
        if (*card != NULL) {
            return sf_fail(err, SHEAR_E_FORMAT, c->at, "leave one of them out",
                           "keyword %s is given twice", key);
        }
        *card = here;
    }
    return SHEAR_OK;
}

int sf_key_double(const sf_cards *c, const char *key, double *value, shear_error *err) {
    const char *card = NULL;
    double v = NAN;
    TRY(sf_cards_find(c, key, &card, err));
    if (card == NULL)
        return SHEAR_OK;
    if (!sf_card_double(card, &v)) {
        return sf_fail(err, SHEAR_E_FORMAT, c->at, "correct the keyword, or leave it out",
                       "keyword %s is not a finite number", key);
    }
    *value = v;
    return SHEAR_OK;
}

/* Parse an integer, which may be written 2.0 or 2E0. */
static bool whole(const char *card, int64_t *out) {
    double v = 0.0;
    if (sf_card_int(card, out))
        return true;
    if (!sf_card_double(card, &v) || v != floor(v) || fabs(v) >= 0x1p63)
        return false;
    *out = (int64_t)v;
    return true;
}

int sf_key_int(const sf_cards *c, const char *key, int64_t min, int64_t max, int64_t *value,
               shear_error *err) {
    const char *card = NULL;
    int64_t v = 0;
    TRY(sf_cards_find(c, key, &card, err));
    if (card == NULL)
        return SHEAR_OK;
    if (!whole(card, &v) || v < min || v > max) {
        char text[SF_CARD + 1];
        char shown[3 * sizeof text];
        sf_card_token(card, text);
        sf_printable_name(shown, sizeof shown, text);
        return sf_fail(err, SHEAR_E_FORMAT, c->at, NULL,
                       "keyword %s is %s, but must be an integer from %lld to %lld", key, shown,
                       (long long)min, (long long)max);
    }
    *value = v;
    return SHEAR_OK;
}

int sf_need_int(const sf_cards *c, const char *key, int64_t min, int64_t max, int64_t *value,
                shear_error *err) {
    *value = SF_ABSENT;
    TRY(sf_key_int(c, key, min, max, value, err));
    return *value != SF_ABSENT
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, c->at, NULL, "keyword %s is missing", key);
}

static bool continues(const sf_cards *c, const char *card) {
    return card < c->text + c->count * SF_CARD && memcmp(card, "CONTINUE", SF_KEY) == 0;
}

/* Append the strings of the CONTINUE cards behind `card` to `out`, as long as it ends with &. */
static void append_continued(const sf_cards *c, const char *card, char *out) {
    size_t n = strlen(out);
    for (card += SF_CARD; n > 0 && out[n - 1] == '&' && continues(c, card); card += SF_CARD) {
        char next[SF_CARD];
        memcpy(next, card, sizeof next);
        memcpy(next, "CONTINUE= ", SF_KEY + 2); /* so that its string is where a value is */
        if (!sf_card_string(next, out + n - 1, SF_CARD))
            break;
        n = strlen(out);
    }
}

int sf_key_string(const sf_cards *c, const char *key, char **text, shear_error *err) {
    const char *card = NULL;
    *text = NULL;
    TRY(sf_cards_find(c, key, &card, err));
    if (card == NULL)
        return SHEAR_OK;
    size_t capacity = 1;
    for (const char *k = card; k == card || continues(c, k); k += SF_CARD)
        capacity += SF_CARD;
    char *out = calloc(1, capacity);
    if (out == NULL)
        return sf_fail_memory(err, c->at);
    if (sf_card_string(card, out, SF_CARD)) {
        append_continued(c, card, out);
    } else {
        sf_card_token(card, out);
    }
    *text = out;
    return SHEAR_OK;
}

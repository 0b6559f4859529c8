/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chip_header.c: the header of a chip, with what it inherits from the primary HDU. */
#include "survey/pixels/internal.h"

#include "base/array.h"
#include "base/buffer.h"
#include "base/cleanup.h"
#include "fits/header/cards.h"

#include <math.h>
#include <string.h>

/* What describes one HDU's data only. */
static const char *const own[] = {"SIMPLE",  "XTENSION", "BITPIX",   "NAXIS",   "EXTEND",  "PCOUNT",
                                  "GCOUNT",  "BSCALE",   "BZERO",    "BLANK",   "EXTNAME", "EXTVER",
                                  "EXTTYPE", "INHERIT",  "CHECKSUM", "DATASUM", NULL};
/* How keywords of a sky map begin: those of two maps must not be mixed. */
static const char *const sky[] = {
    "CTYPE", "CRVAL", "CRPIX", "CDELT",   "CROTA",   "CUNIT",   "CD1_", "CD2_", "PC1_",
    "PC2_",  "PV1_",  "PV2_",  "PS1_",    "PS2_",    "A_",      "B_",   "AP_",  "BP_",
    "WAT0_", "WAT1_", "WAT2_", "WCSAXES", "LONPOLE", "LATPOLE", "LTV",  "LTM",  NULL};

static bool begins(const char *card, const char *const *words) {
    for (int i = 0; words[i] != NULL; i++) {
        if (strncmp(card, words[i], strlen(words[i])) == 0)
            return true;
    }
    return false;
}

/* Return the first card of a keyword, padded to 8 characters, or NULL. */
static const char *find_first(const char *text, int64_t count, const char key[SF_KEY]) {
    for (int64_t i = 0; i < count; i++) {
        if (memcmp(text + i * SF_CARD, key, SF_KEY) == 0)
            return text + i * SF_CARD;
    }
    return NULL;
}

/* ---- inheritance ---- */

static int compare_keys(const void *a, const void *b) {
    return memcmp(a, b, SF_KEY);
}

/* Return the keywords of a header, sorted, [count][SF_KEY]; NULL if out of memory. */
static char *sorted_keys(const sf_cards *cards) {
    char *keys = malloc((size_t)cards->count * SF_KEY + 1);
    for (int64_t i = 0; keys != NULL && i < cards->count; i++)
        memcpy(keys + i * SF_KEY, cards->text + i * SF_CARD, SF_KEY);
    if (keys != NULL)
        qsort(keys, (size_t)cards->count, SF_KEY, compare_keys);
    return keys;
}

static bool wants(const char *card, const char *keys, int64_t n, bool has_sky) {
    return memcmp(card + SF_KEY, "= ", 2) == 0 && !begins(card, own) &&
           !(has_sky && begins(card, sky)) &&
           bsearch(card, keys, (size_t)n, SF_KEY, compare_keys) == NULL;
}

/* Append the cards of the primary header that the chip's does not have. */
static int inherit(buffer *joined, const sf_cards *cards, const sf_cards *primary,
                   shear_error *err) {
    CLEANUP(release_free) char *keys = sorted_keys(cards);
    if (keys == NULL)
        return sf_fail_memory(err, cards->at);
    const bool has_sky = find_first(cards->text, cards->count, "CTYPE1  ") != NULL;
    bool wanted = false;
    for (int64_t i = 0; i < primary->count; i++) {
        const char *card = primary->text + i * SF_CARD;
        if (memcmp(card, "CONTINUE", SF_KEY) != 0) /* which goes with the card before it */
            wanted = wants(card, keys, cards->count, has_sky);
        if (wanted)
            buffer_add(joined, card, SF_CARD);
    }
    return SHEAR_OK;
}

static bool inherits(const sf_cards *cards) {
    const char *card = find_first(cards->text, cards->count, "INHERIT ");
    bool yes = true;
    return cards->hdu->number > 0 && (card == NULL || !sf_card_logical(card, &yes) || yes);
}

static int join(buffer *joined, const image_hdu *image, shear_error *err) {
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    CLEANUP(sf_cards_deinit) sf_cards primary = {0};
    TRY(sf_cards_init(&cards, image->file, image->hdu, image->label, err));
    buffer_add(joined, cards.text, (size_t)cards.count * SF_CARD);
    if (!inherits(&cards))
        return SHEAR_OK;
    TRY(sf_cards_init(&primary, image->file, &image->file->hdus[0], "primary", err));
    return inherit(joined, &cards, &primary, err);
}

/* ---- SATURATE ---- */

/* Return the saturation level, NaN if there is none: some pipelines write 0 or a huge number. */
static double saturation(const char *header, int64_t cards) {
    const char *card = find_first(header, cards, "SATURATE");
    double level = NAN;
    return card != NULL && sf_card_double(card, &level) && level > 0.0 && level < 1e30 ? level
                                                                                       : NAN;
}

int image_chip_read_header(image_chip *chip, shear_error *err) {
    CLEANUP(buffer_deinit) buffer joined = {0};
    TRY(join(&joined, &chip->layers[LAYER_IMAGE], err));
    size_t bytes = 0;
    chip->header = buffer_take(&joined, &bytes);
    if (chip->header == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    chip->cards = (int64_t)bytes / SF_CARD;
    chip->saturate = saturation(chip->header, chip->cards);
    return SHEAR_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/cards.h: one HDU's header in memory, and its keywords.
 *
 * A keyword that is looked up must not appear twice. A keyword without a value counts as absent. */
#pragma once

#include "fits/header/card.h"
#include "fits/header/file.h"

#include <stdint.h>

typedef struct sf_cards {
    const sf_file *file;
    const sf_hdu *hdu;
    sf_place at; /* file and HDU for messages; the strings are the caller's */
    char *text;  /* [count][SF_CARD] */
    int64_t count;
} sf_cards;

/* Read the header of `hdu`, which must not have changed since the file was opened. SHEAR_E_IO,
 * SHEAR_E_FORMAT, SHEAR_E_NOMEM. Call sf_cards_deinit after an error, too. */
int sf_cards_init(sf_cards *c, const sf_file *file, const sf_hdu *hdu, const char *label,
                  shear_error *err);
void sf_cards_deinit(sf_cards *c);

/* Find the card of a keyword; *card is NULL if it is absent. SHEAR_E_FORMAT: there are two. */
int sf_cards_find(const sf_cards *c, const char *key, const char **card, shear_error *err);

/* Read a number. If the keyword is absent, *value is unchanged: begin with NAN or SF_ABSENT to see
 * that. SHEAR_E_FORMAT: the value is not a finite number, or not an integer in [min, max]. */
int sf_key_double(const sf_cards *c, const char *key, double *value, shear_error *err);
int sf_key_int(const sf_cards *c, const char *key, int64_t min, int64_t max, int64_t *value,
               shear_error *err);
/* The same for a keyword that must be present. */
int sf_need_int(const sf_cards *c, const char *key, int64_t min, int64_t max, int64_t *value,
                shear_error *err);
/* Read a string, which may continue over several cards. *text is malloc'd; NULL if the keyword is
 * absent. A value that is not a string is copied as it is. */
int sf_key_string(const sf_cards *c, const char *key, char **text, shear_error *err);

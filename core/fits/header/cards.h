/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/cards.h: one HDU's header in memory, and its keywords.
 *
 * A keyword that is asked for may stand in the header only once. A keyword without a value counts
 * as not there.
 */
#ifndef SHEAR_FITS_HEADER_CARDS_H
#define SHEAR_FITS_HEADER_CARDS_H

#include "fits/header/file.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct sf_cards {
    sf_place at; /* what is named in messages; the caller's */
    char *text;  /* [count][SF_CARD] */
    int64_t count;
} sf_cards;

/* Read the header of `hdu`, which must be as it was when the file was opened. Deinit it, also after
 * an error. SHEAR_E_IO, SHEAR_E_FORMAT, SHEAR_E_NOMEM. */
int sf_cards_init(sf_cards *c, const sf_file *file, const sf_hdu *hdu, const char *label,
                  shear_error *err);
void sf_cards_deinit(sf_cards *c);

/* The card of a keyword; NULL if it is absent. SHEAR_E_FORMAT: there are two. */
int sf_cards_find(const sf_cards *c, const char *key, const char **card, shear_error *err);

/* *found tells whether the keyword is there; the value is left alone where it is not.
 * SHEAR_E_FORMAT: the value is no finite number; no integer in [min, max]. */
int sf_key_double(const sf_cards *c, const char *key, double *value, bool *found, shear_error *err);
int sf_key_int(const sf_cards *c, const char *key, int64_t min, int64_t max, int64_t *value,
               bool *found, shear_error *err);
/* The same where the keyword must be there. */
int sf_need_int(const sf_cards *c, const char *key, int64_t min, int64_t max, int64_t *value,
                shear_error *err);
/* Strings may continue over several cards; *text is malloc'd, NULL where not found. What is no
 * string is taken as it stands. */
int sf_key_string(const sf_cards *c, const char *key, char **text, shear_error *err);

#endif

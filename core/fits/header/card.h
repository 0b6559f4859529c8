/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/card.h: one 80-character header card ("KEYWORD = value / comment"). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SF_CARD = 80, SF_KEY = 8, SF_INDEXED = SF_KEY + 16 };

/* Stands for an integer that is absent: sf_card_int and sf_key_int never return it. */
#define SF_ABSENT INT64_MIN

/* Copy the keyword, without trailing blanks. */
void sf_card_key(const char card[SF_CARD], char key[SF_KEY + 1]);
/* Return the number after `root` in a keyword such as NAXIS12: 12; 0 if it is not root and
 * number. */
int sf_card_index(const char *key, const char *root);

/* Format a keyword that ends in a number, such as NAXIS2, into `key`. Return key. */
const char *sf_card_indexed(char key[SF_INDEXED], const char *root, int index);

/* Parse the value as an integer, logical or string (without trailing blanks, truncated to size).
 * Return false if the card has no value of that type. */
bool sf_card_int(const char card[SF_CARD], int64_t *out);
bool sf_card_logical(const char card[SF_CARD], bool *out);
/* Parse any finite number in FITS notation (1, 1.5, 1.5E3, 1.5D3). Return false if it is not
 * one. */
bool sf_card_double(const char card[SF_CARD], double *out);
/* Return whether there is a value of any type. */
bool sf_card_has_value(const char card[SF_CARD]);
/* Copy the value's characters as they are, without the comment. */
void sf_card_token(const char card[SF_CARD], char out[SF_CARD + 1]);
bool sf_card_string(const char card[SF_CARD], char *out, size_t size);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/sums_text.h: exact sums as stored in the database. The text of sums has about 240 zeros at
 * the end of each of its 64 terms (the exact accumulator reaches down to the smallest double),
 * about 17 KiB in all. With runs of zeros replaced by their length a term takes 36 bytes, 27 of
 * them the hexadecimal digits of its two doubles, and all terms less than 2.5 KiB. */
#pragma once

#include "base/cleanup.h"
#include "shear/sums.h"

CLEANUP_DEFINE(shear_field_sums, shear_field_sums_free)

/* Parse sums given by the store's caller. STORE_BAD_TEXT if missing or too long, SHEAR_E_INTERNAL
 * if they cannot be read (SHEAR_E_FORMAT is for what the database holds). */
int sums_parse_given(shear_field_sums **sums, const char *text, shear_error *err);

/* Pack a text. *packed is malloc'd, the caller's. */
int sums_pack(const char *text, char **packed, shear_error *err);
/* Unpack into *text, malloc'd, the caller's. SHEAR_E_FORMAT if `packed` cannot be read or would
 * unpack to more than STORE_SUMS_MAX bytes. */
int sums_unpack(const char *packed, char **text, shear_error *err);

/* Convert packed texts to sums, and back; the results are the caller's. */
int sums_parse_packed(shear_field_sums **sums, const char *packed, shear_error *err);
int sums_format_packed(const shear_field_sums *sums, char **packed, shear_error *err);

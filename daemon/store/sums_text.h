/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/sums_text.h: exact sums as kept in the database. Their text has some 240 zeros at the end
 * of each of its 58 terms (the exact accumulator reaches down to the smallest double), 16 KiB in
 * all. With the runs of zeros counted a term takes 36 bytes, its two doubles' 27 hexadecimal digits
 * among them, and all of them less than 2.5 KiB. */
#ifndef SHEARD_STORE_SUMS_TEXT_H
#define SHEARD_STORE_SUMS_TEXT_H

#include "base/cleanup.h"
#include "shear/sums.h"

CLEANUP_DEFINE(shear_field_sums, shear_field_sums_free)

/* Sums that the caller of the store gave: STORE_BAD_TEXT where too long or missing,
 * SHEAR_E_INTERNAL where they cannot be read (SHEAR_E_FORMAT is for what the database holds). */
int sums_parse_given(shear_field_sums **sums, const char *text, shear_error *err);

/* Both results are malloc'd, the caller's. */
int sums_pack(const char *text, char **packed, shear_error *err);
/* SHEAR_E_FORMAT where `packed` cannot be read, or would unpack to more than STORE_SUMS_MAX bytes.
 */
int sums_unpack(const char *packed, char **text, shear_error *err);

/* From the packed text to the sums, and back. */
int sums_parse_packed(shear_field_sums **sums, const char *packed, shear_error *err);
int sums_format_packed(const shear_field_sums *sums, char **packed, shear_error *err);

#endif

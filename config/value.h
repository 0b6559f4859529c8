/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value.h: one value: text <-> member. */
#ifndef CONFIG_VALUE_H
#define CONFIG_VALUE_H

#include "base/member.h"
#include "sheard/config.h"

/* Longest text of a single value (not of lists). */
enum { VALUE_TEXT_MAX = 256 };

/* A value of any type but SHEARD_T_MEASURE. All begin at the union's address, as in a config. */
typedef union value {
    member_value member; /* INT, BYTES, DURATION: count; MODE: bits; CHOICE: number */
    sheard_list list;
} value;

bool value_is_list(const sheard_setting *s);
/* How the member of a setting that is no list lies in memory. */
enum member_type value_member_type(const sheard_setting *s);

/* Parse `text` (no white space around it) as the value of `s`. *value is owned by the caller on
 * SHEAR_OK and untouched otherwise. SHEAR_E_SETTING names the setting, what was given and what is
 * expected. */
int value_parse(const sheard_setting *s, const char *text, value *parsed, shear_error *err);

/* Numbers only (also modes); the same on `*number`. */
int number_parse(const sheard_setting *s, const char *text, int64_t *number, shear_error *err);

/* A number in the way of the setting's type, with the largest unit that leaves a whole number:
 * "90s", "4K", "0660". The word if there is one for 0. Returns buf. */
char *number_format(const sheard_setting *s, int64_t number, char *buf, size_t size);

/* What is expected of a number: "a whole number from 1 to 1024, or auto". Returns buf. */
char *number_expected(const sheard_setting *s, char *buf, size_t size);

/* malloc'd, NULL when memory is out; lists are joined with ", ". */
char *value_format(const sheard_setting *s, const void *member);

bool value_equal(const sheard_setting *s, const void *a, const void *b);

/* Release what the member owns. */
void value_deinit(const sheard_setting *s, void *member);

/* Bytes of the member. */
size_t value_size(const sheard_setting *s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value.h: convert a setting's value between text and its member. */
#pragma once

#include "base/member.h"
#include "sheard/config.h"

/* Longest text of a single value (not of lists), in bytes. */
enum { VALUE_TEXT_MAX = 256 };

/* A value of any type but SHEARD_T_MEASURE. Every member is at the union's address, as in a config.
 */
typedef union value {
    member_value member; /* INT, BYTES, DURATION: count; MODE: bits; CHOICE: index */
    sheard_list list;
} value;

bool value_is_list(const sheard_setting *s);
/* Return the word for a value in the usage of an option: "PATH". */
const char *value_placeholder(const sheard_setting *s);
/* Describe the values allowed: "a whole number of jobs from 1 to 1024, or auto". Not for
 * SHEARD_T_MEASURE. Return buf. */
char *value_expected(const sheard_setting *s, char *buf, size_t size);

/* Parse `text`, without white space around it, as the value of `s`. On SHEAR_OK the caller owns
 * *parsed, otherwise it is unchanged. The message of SHEAR_E_SETTING names the setting, the text
 * given and what is expected. */
int value_parse(const sheard_setting *s, const char *text, value *parsed, shear_error *err);

/* Parse a number (also a mode) into *number. Return false if the text is not a number
 * in the range. */
bool number_parse(const sheard_setting *s, const char *text, int64_t *number);

/* Format a number according to the setting's type, with the largest unit that leaves a whole
 * number: "90s", "4K", "0660"; or the word for 0, if there is one. Return buf. */
char *number_format(const sheard_setting *s, int64_t number, char *buf, size_t size);

/* Format a value, from malloc; lists are joined with ", ". Return NULL if out of memory. */
char *value_format(const sheard_setting *s, const void *member);

/* Return whether two members have equal values. */
bool value_equal(const sheard_setting *s, const void *a, const void *b);

/* Free what the member owns. */
void value_deinit(const sheard_setting *s, void *member);

/* Return the size of the member in bytes. */
size_t value_size(const sheard_setting *s);

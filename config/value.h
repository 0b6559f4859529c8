/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value.h: one value: text <-> member. */
#ifndef CONFIG_VALUE_H
#define CONFIG_VALUE_H

#include "sheard/config.h"

/* Longest text of a single value (not of lists). */
enum { VALUE_TEXT_MAX = 256 };

/* A value of any type but SHEARD_T_MEASURE. All members begin at the union's address, as in a
 * config. */
union value {
    char *text;
    sheard_list list;
    int64_t number;
    unsigned mode;
    int choice;
    bool flag;
};

/* Parse `text` (no white space around it) as the value of `s`. *value is owned by the caller on
 * SHEAR_OK and untouched otherwise. SHEAR_E_SETTING names the setting, what was given and what is
 * expected. */
int value_parse(const sheard_setting *s, const char *text, union value *value, shear_error *err);

/* Numbers only (also modes); the same on `*number`. */
int number_parse(const sheard_setting *s, const char *text, int64_t *number, shear_error *err);

/* A number in the way of the setting's type, with the largest unit that leaves a whole number:
 * "90s", "4K", "0660". The word where there is one for 0. Returns buf. */
char *number_format(const sheard_setting *s, int64_t number, char *buf, size_t size);

/* What is expected of a number: "a whole number from 1 to 1024, or auto". Returns buf. */
char *number_expected(const sheard_setting *s, char *buf, size_t size);

/* malloc'd, NULL when out of memory; lists are joined with ", ". */
char *value_format(const sheard_setting *s, const void *member);

bool value_equal(const sheard_setting *s, const void *a, const void *b);

/* Release what the member owns. */
void value_deinit(const sheard_setting *s, void *member);

/* Bytes of the member. */
size_t value_size(const sheard_setting *s);

#endif

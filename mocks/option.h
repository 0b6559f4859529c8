/* SPDX-License-Identifier: GPL-3.0-or-later */
/* option.h: the value of an option, in the struct that its table describes: parsed, checked, and
 * written as text. */
#pragma once

#include "shear_mocks/mock.h"

/* The rows of a table. The file that has it defines AT(member), the offset in its struct. */
#define ROW(name, type, member, min, max, metavar, help)                                           \
    { name, AT(member), NULL, min, max, metavar, help, SHEAR_MOCK_T_##type, false }
#define ROW_AUTO(name, type, member, min, max, metavar, help)                                      \
    { name, AT(member), NULL, min, max, metavar, help, SHEAR_MOCK_T_##type, true }
#define CHOICE(name, member, choices, metavar, help)                                               \
    { name, AT(member), choices, 0, 0, metavar, help, SHEAR_MOCK_T_CHOICE, false }
#define SWITCH(name, type, member, help) ROW(name, type, member, 0, 0, NULL, help)

/* A table of options. */
typedef struct option_table {
    const shear_mock_option *rows;
    size_t n;
} option_table;

/* Return the row called `name`, or NULL. */
const shear_mock_option *option_find(const option_table *t, const char *name);
/* Parse, as shear_mock_set, into *spec. */
int option_set(const option_table *t, void *spec, const char *name, const char *text,
               shear_error *err);
/* Check every number against its option's range, every choice against its list. Returns SHEAR_OK,
 * or SHEAR_E_SETTING with a message. */
int option_check_ranges(const option_table *t, const void *spec, shear_error *err);
/* Write the value so that option_set reads back the same bits. Returns buf. */
char *option_format(const void *spec, const shear_mock_option *option, char *buf, size_t size);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact/exact.h: exact sums of doubles.
 *
 * Every finite double is an integer multiple of 2^-1074. A sum is kept as that integer (GMP), so
 * that adding and joining never round and the order does not matter. Only exact_value rounds, once,
 * to the nearest double (ties away from zero). */
#pragma once

#include <stdbool.h>

typedef struct exact_sum exact_sum;

exact_sum *exact_new(int n); /* an array of n zero sums; NULL if out of memory */
void exact_free(exact_sum *sums, int n);
void exact_add(exact_sum *sums, int i, double value); /* value must be finite */
void exact_join(exact_sum *sums, const exact_sum *other, int n);
void exact_leave(exact_sum *sums, const exact_sum *other, int n); /* reverses exact_join */
double exact_value(const exact_sum *sums, int i);
/* Return sum i as hexadecimal text, malloc'd; NULL if out of memory. */
char *exact_format(const exact_sum *sums, int i);
/* Set sum i from such text. Return false if the text is not such a number. */
bool exact_parse(exact_sum *sums, int i, const char *text);

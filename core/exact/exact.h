/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact/exact.h: an exact sum of doubles.
 *
 * Every finite double is an integer multiple of 2^-1074; the sum is kept as that integer (GMP), so
 * adding and joining never round and the order does not matter. Only exact_value rounds, once, to
 * the nearest double (a tie goes away from zero).
 */
#ifndef SHEAR_EXACT_EXACT_H
#define SHEAR_EXACT_EXACT_H

#include <stdbool.h>

typedef struct exact_sum exact_sum;

exact_sum *exact_new(int n); /* an array of n zero sums; NULL when memory is out */
void exact_free(exact_sum *sums, int n);
void exact_add(exact_sum *sums, int i, double value); /* value must be finite */
void exact_join(exact_sum *sums, const exact_sum *other, int n);
void exact_leave(exact_sum *sums, const exact_sum *other, int n); /* undoes exact_join */
double exact_value(const exact_sum *sums, int i);
/* Hexadecimal text of sum i, malloc'd; NULL when memory is out. */
char *exact_format(const exact_sum *sums, int i);
/* Read it back; false where the text is not such a number. */
bool exact_parse(exact_sum *sums, int i, const char *text);

#endif

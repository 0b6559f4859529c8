/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/sort.h: numbers in ascending order. */
#ifndef BASE_SORT_H
#define BASE_SORT_H

#include <stddef.h>

/* None may be NaN. */
void sort_doubles(double *values, size_t n);

#endif

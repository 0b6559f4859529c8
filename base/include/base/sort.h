/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/sort.h: sort doubles in ascending order. */
#pragma once

#include <stddef.h>

/* Sort n values, none of which may be NaN. */
void sort_doubles(double *values, size_t n);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rank.h: Spearman's rank correlation of two quantities of many stamps. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { RANK_MAX = 1000000 }; /* values; up to this number sums are exact */

typedef struct rank_relation {
    double correlation; /* Spearman's; equal values have their mean rank. NaN if n is 0, if all
                           values of one quantity are equal, or if out of memory */
    size_t n;
} rank_relation;

/* Return the relation of x [n] and y [n], all finite, n <= RANK_MAX. The result is the same to the
 * last bit for any order of the pairs. */
rank_relation rank_relate(const double *x, const double *y, size_t n);

/* Return whether the correlation is strong and significant: |correlation| is above 0.5 and above
 * 5/sqrt(n - 1), five standard deviations of uncorrelated values. */
bool rank_is_strong(const rank_relation *r);

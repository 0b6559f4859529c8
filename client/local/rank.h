/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rank.h: do two quantities of many stamps go together, whatever the relation's form? */
#ifndef CLIENT_LOCAL_RANK_H
#define CLIENT_LOCAL_RANK_H

#include <stdbool.h>
#include <stddef.h>

enum { RANK_MAX = 1000000 }; /* values; sums are exact up to here */

typedef struct rank_relation {
    double correlation; /* Spearman's; equal values share their mean rank. NaN where n is 0, all
                           values of one quantity are equal, or there was no memory */
    size_t n;
} rank_relation;

/* x [n], y [n], all finite, n <= RANK_MAX. The same to the last bit for any order of pairs. */
rank_relation rank_relate(const double *x, const double *y, size_t n);

/* Is it beyond doubt and strong? |correlation| above 0.5 and five standard deviations of none, 1 /
 * sqrt(n - 1). */
bool rank_is_strong(const rank_relation *r);

#endif

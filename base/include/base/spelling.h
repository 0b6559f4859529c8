/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/spelling.h: names as people write them. '-' and '_' are the same in them. */
#ifndef BASE_SPELLING_H
#define BASE_SPELLING_H

#include <stdbool.h>

/* Are they the same name? Case matters. */
bool spelling_same(const char *a, const char *b);

/* The name that was probably meant. Begin with {.given = name}, show all candidates; `best` is then
 * the nearest, the first of equals, or NULL if none is near: at most a third of its letters are
 * inserted, deleted, changed or swapped with their neighbour, upper and lower case being the same.
 */
typedef struct spelling {
    const char *given;
    const char *best;
    unsigned distance; /* of the best */
} spelling;

void spelling_consider(spelling *s, const char *candidate);

#endif

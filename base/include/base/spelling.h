/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/spelling.h: compare names as people write them, with '-' and '_' as the same character. */
#pragma once

#include <stdbool.h>

/* Return whether two names are the same. Case matters. */
bool spelling_same(const char *a, const char *b);

/* Return the index of the name in `words`, an array ended by NULL, or -1. */
int spelling_find(const char *const *words, const char *name);

/* A search for the name that was probably meant. Begin with {.given = name} and pass all candidates
 * to spelling_consider. `best` is then the nearest candidate, the first of equals, or NULL if none
 * is near: at most a third of its letters may be inserted, deleted, changed or swapped with the
 * next one. Case does not matter. */
typedef struct spelling {
    const char *given;
    const char *best;
    unsigned distance; /* of `best` */
} spelling;

void spelling_consider(spelling *s, const char *candidate);

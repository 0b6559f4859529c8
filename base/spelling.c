/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/spelling.h"

#include <ctype.h>
#include <stddef.h>
#include <string.h>

enum { LONGEST = 48 }; /* longer than any name in this project; a longer name has no match */

bool spelling_same(const char *a, const char *b) {
    for (; *a != '\0' && *b != '\0'; a++, b++) {
        if ((*a == '_' ? '-' : *a) != (*b == '_' ? '-' : *b))
            return false;
    }
    return *a == *b;
}

int spelling_find(const char *const *words, const char *name) {
    for (int i = 0; words[i] != NULL; i++) {
        if (spelling_same(words[i], name))
            return i;
    }
    return -1;
}

static unsigned least(unsigned a, unsigned b) {
    return a < b ? a : b;
}

static int folded(char c) {
    return c == '-' ? '_' : tolower((unsigned char)c);
}

/* Return the number of letters to insert, delete, change or swap with the next one to turn a into b
 * (the Damerau-Levenshtein distance in which no letter is changed twice). */
static unsigned distance(const char *a, size_t na, const char *b, size_t nb) {
    unsigned d[LONGEST + 1][LONGEST + 1];
    for (size_t i = 0; i <= na; i++) {
        for (size_t j = 0; j <= nb; j++) {
            if (i == 0 || j == 0) {
                d[i][j] = (unsigned)(i + j);
                continue;
            }
            const unsigned change = folded(a[i - 1]) != folded(b[j - 1]);
            d[i][j] = least(least(d[i - 1][j], d[i][j - 1]) + 1, d[i - 1][j - 1] + change);
            if (i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) &&
                folded(a[i - 2]) == folded(b[j - 1])) {
                d[i][j] = least(d[i][j], d[i - 2][j - 2] + 1);
            }
        }
    }
    return d[na][nb];
}

void spelling_consider(spelling *s, const char *candidate) {
    const size_t na = strlen(s->given);
    const size_t nb = strlen(candidate);
    if (na > LONGEST || nb > LONGEST)
        return;
    const unsigned d = distance(s->given, na, candidate, nb);
    if (d <= (nb + 2) / 3 && (s->best == NULL || d < s->distance)) {
        s->best = candidate;
        s->distance = d;
    }
}

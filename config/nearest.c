/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The name that was probably meant. */
#include "table.h"

#include <ctype.h>
#include <string.h>

enum { LONGEST = 32 }; /* no name of ours is longer; what is longer resembles none */

static unsigned least(unsigned a, unsigned b) {
    return a < b ? a : b;
}

static int folded(char c) {
    return c == '-' ? '_' : tolower((unsigned char)c);
}

/* Letters to insert, delete, change or swap with their neighbour to make b of a. */
static unsigned distance(const char *a, const char *b) {
    unsigned d[LONGEST + 1][LONGEST + 1];
    size_t na = strlen(a);
    size_t nb = strlen(b);
    for (size_t i = 0; i <= na; i++) {
        for (size_t j = 0; j <= nb; j++) {
            if (i == 0 || j == 0) {
                d[i][j] = (unsigned)(i + j);
                continue;
            }
            unsigned change = folded(a[i - 1]) != folded(b[j - 1]);
            d[i][j] = least(least(d[i - 1][j], d[i][j - 1]) + 1, d[i - 1][j - 1] + change);
            if (i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) &&
                folded(a[i - 2]) == folded(b[j - 1])) {
                d[i][j] = least(d[i][j], d[i - 2][j - 2] + 1);
            }
        }
    }
    return d[na][nb];
}

/* Keeps in *best the nearest so far, if it is near: at most a third of its letters are wrong. */
static void consider(const char *name, const char *candidate, const char **best,
                     unsigned *best_distance) {
    if (strlen(name) > LONGEST || strlen(candidate) > LONGEST) {
        return;
    }
    unsigned d = distance(name, candidate);
    if (d <= (strlen(candidate) + 2) / 3 && (*best == NULL || d < *best_distance)) {
        *best = candidate;
        *best_distance = d;
    }
}

const char *config_nearest_section(const char *name) {
    const char *best = NULL;
    unsigned best_distance = 0;
    for (size_t i = 0; i < config_n_sections; i++) {
        consider(name, config_sections[i].name, &best, &best_distance);
    }
    return best;
}

const char *config_nearest_key(const char *section, const char *key) {
    const char *best = NULL;
    unsigned best_distance = 0;
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        if (strcmp(s.section, section) == 0) {
            consider(key, s.key, &best, &best_distance);
        }
    }
    return best;
}

const char *config_section_of(const char *key) {
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        if (config_same_name(s.key, key)) {
            return s.section;
        }
    }
    return NULL;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/card.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VALUE = 10 }; /* first column of the value */

void sf_card_key(const char card[SF_CARD], char key[SF_KEY + 1]) {
    int n = SF_KEY;
    while (n > 0 && card[n - 1] == ' ')
        n--;
    memcpy(key, card, (size_t)n);
    key[n] = '\0';
}

int sf_card_index(const char *key, const char *root) {
    const size_t length = strlen(root);
    if (strncmp(key, root, length) != 0 || key[length] < '1' || key[length] > '9')
        return 0;
    int index = 0;
    for (const char *c = key + length; *c != '\0'; c++) {
        if (*c < '0' || *c > '9')
            return 0;
        index = 10 * index + (*c - '0'); /* at most 7 digits */
    }
    return index;
}

const char *sf_card_indexed(char key[SF_INDEXED], const char *root, int index) {
    snprintf(key, SF_INDEXED, "%s%d", root, index);
    return key;
}

/* Return the first column of the value that is not blank, or SF_CARD. */
static int value_start(const char card[SF_CARD]) {
    if (card[SF_KEY] != '=' || card[SF_KEY + 1] != ' ')
        return SF_CARD;
    int i = VALUE;
    while (i < SF_CARD && card[i] == ' ')
        i++;
    return i;
}

/* Return whether only blanks are left before the comment. */
static bool value_ends(const char card[SF_CARD], int i) {
    while (i < SF_CARD && card[i] == ' ')
        i++;
    return i == SF_CARD || card[i] == '/';
}

bool sf_card_int(const char card[SF_CARD], int64_t *out) {
    int i = value_start(card);
    const bool negative = i < SF_CARD && card[i] == '-';
    if (i < SF_CARD && (card[i] == '-' || card[i] == '+'))
        i++;
    int digits = 0;
    int64_t value = 0; /* below zero, where there is one number more */
    for (; i < SF_CARD && card[i] >= '0' && card[i] <= '9'; i++, digits++) {
        if (__builtin_mul_overflow(value, 10, &value) ||
            __builtin_sub_overflow(value, card[i] - '0', &value)) {
            return false;
        }
    }
    if (!negative && value == INT64_MIN)
        return false;
    *out = negative ? value : -value;
    return digits > 0 && value_ends(card, i);
}

bool sf_card_logical(const char card[SF_CARD], bool *out) {
    const int i = value_start(card);
    if (i == SF_CARD || (card[i] != 'T' && card[i] != 'F'))
        return false;
    *out = card[i] == 'T';
    return value_ends(card, i + 1);
}

bool sf_card_double(const char card[SF_CARD], double *out) {
    char text[SF_CARD + 1];
    const int start = value_start(card);
    int n = 0;
    for (int i = start;
         i < SF_CARD && card[i] != '\0' && strchr("+-.0123456789EeDd", card[i]) != NULL; i++) {
        const bool fortran = card[i] == 'D' || card[i] == 'd';
        text[n] = 'E';
        if (!fortran)
            text[n] = card[i];
        n++;
    }
    text[n] = '\0';
    char *end = text;
    const double value = strtod(text, &end);
    *out = value;
    return n > 0 && *end == '\0' && isfinite(value) && value_ends(card, start + n);
}

bool sf_card_has_value(const char card[SF_CARD]) {
    const int i = value_start(card);
    return i < SF_CARD && card[i] != '/';
}

void sf_card_token(const char card[SF_CARD], char out[SF_CARD + 1]) {
    int n = 0;
    for (int i = value_start(card); i < SF_CARD && card[i] != '/'; i++)
        out[n++] = card[i];
    while (n > 0 && out[n - 1] == ' ')
        n--;
    out[n] = '\0';
}

bool sf_card_string(const char card[SF_CARD], char *out, size_t size) {
    int i = value_start(card);
    if (i == SF_CARD || card[i] != '\'')
        return false;
    size_t n = 0;
    for (i++; i < SF_CARD; i++) {
        if (card[i] == '\'' && (i + 1 == SF_CARD || card[++i] != '\'')) {
            break; /* two quotes stand for one */
        }
        if (n + 1 < size)
            out[n++] = card[i];
    }
    while (n > 0 && out[n - 1] == ' ')
        n--;
    out[n] = '\0';
    return true;
}

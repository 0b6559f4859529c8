/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "text.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FITS_STRING = 68 };

/* strto... skips leading space; a value has none. */
static bool begins(const char *text) {
    return *text != '\0' && !isspace((unsigned char)*text);
}

bool text_int64(const char *text, int64_t *value) {
    char *end = NULL;
    errno = 0;
    intmax_t v = strtoimax(text, &end, 10);
    if (!begins(text) || *end || errno) {
        return false;
    }
    *value = v;
    return true;
}

bool text_int(const char *text, int *value) {
    int64_t v = 0;
    if (!text_int64(text, &v) || v < INT_MIN || v > INT_MAX) {
        return false;
    }
    *value = (int)v;
    return true;
}

bool text_uint64(const char *text, uint64_t *value) {
    char *end = NULL;
    errno = 0;
    uintmax_t v = strtoumax(text, &end, 10);
    /* strtoumax takes "-1" for 2^64 - 1 */
    if (!isdigit((unsigned char)*text) || *end || errno) {
        return false;
    }
    *value = v;
    return true;
}

/* A number that ends at `stop`. */
static bool double_until(const char *text, char stop, double *value, const char **end) {
    char *rest = NULL;
    double v = strtod(text, &rest);
    if (!begins(text) || rest == text || *rest != stop || !isfinite(v)) {
        return false;
    }
    *value = v;
    *end = rest;
    return true;
}

bool text_double(const char *text, double *value) {
    const char *end;
    return double_until(text, '\0', value, &end);
}

bool text_pair(const char *text, double value[2]) {
    const char *end;
    return double_until(text, ',', &value[0], &end) && text_double(end + 1, &value[1]);
}

bool text_size(const char *text, int value[2]) {
    char first[16];
    const char *x = strchr(text, 'x');
    if (x == NULL) {
        bool good = text_int(text, &value[0]);
        value[1] = value[0];
        return good;
    }
    if (x - text >= (ptrdiff_t)sizeof first) {
        return false;
    }
    snprintf(first, sizeof first, "%.*s", (int)(x - text), text);
    return text_int(first, &value[0]) && text_int(x + 1, &value[1]);
}

bool text_bool(const char *text, bool *value) {
    *value = strcmp(text, "yes") == 0;
    return *value || strcmp(text, "no") == 0;
}

bool text_choice(const char *text, const char *const *choices, int *value) {
    for (int i = 0; choices[i]; i++) {
        if (strcmp(text, choices[i]) == 0) {
            *value = i;
            return true;
        }
    }
    return false;
}

bool text_copy(const char *text, char *value, size_t size) {
    size_t n = strnlen(text, FITS_STRING + 1);
    if (n > FITS_STRING || n >= size) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        if (text[i] < ' ' || text[i] > '~') {
            return false;
        }
    }
    memset(value, 0, size);
    memcpy(value, text, n);
    return true;
}

const char *text_of_double(double value, char buf[32]) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(buf, 32, "%.*g", digits, value);
        if (strtod(buf, NULL) == value) {
            break;
        }
    }
    return buf;
}

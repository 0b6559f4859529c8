/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "value.h"

#include "base/text.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FITS_STRING = 68 };

/* strtod and others skip leading space, which is not allowed here. */
static bool begins(const char *text) {
    return *text != '\0' && !isspace((unsigned char)*text);
}

bool value_int64(const char *text, int64_t *value) {
    return begins(text) && text_to_int64(text, value);
}

bool value_int(const char *text, int *value) {
    int64_t v = 0;
    if (!value_int64(text, &v) || v < INT_MIN || v > INT_MAX)
        return false;
    *value = (int)v;
    return true;
}

bool value_uint64(const char *text, uint64_t *value) {
    char *end = NULL;
    errno = 0;
    uintmax_t v = strtoumax(text, &end, 10);
    /* strtoumax accepts "-1" as 2^64 - 1 */
    if (!isdigit((unsigned char)*text) || *end || errno)
        return false;
    *value = v;
    return true;
}

bool value_double(const char *text, double *value) {
    double v = 0.0;
    if (!begins(text) || !text_to_double(text, &v) || !isfinite(v))
        return false;
    *value = v;
    return true;
}

bool value_bool(const char *text, bool *value) {
    *value = strcmp(text, "yes") == 0;
    return *value || strcmp(text, "no") == 0;
}

bool value_copy(const char *text, char *value, size_t size) {
    size_t n = strnlen(text, FITS_STRING + 1);
    if (n > FITS_STRING || n >= size)
        return false;
    for (size_t i = 0; i < n; i++) {
        if (text[i] < ' ' || text[i] > '~')
            return false;
    }
    memset(value, 0, size);
    memcpy(value, text, n);
    return true;
}

const char *value_of_double(double value, char buf[32]) {
    snprintf(buf, 32, "%.*g", text_digits(value, 15), value);
    return buf;
}

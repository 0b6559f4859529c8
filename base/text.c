/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/text.h"

#include <assert.h>
#include <errno.h>
#include <float.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool text_set(char *buf, size_t size, const char *text) {
    buf[0] = '\0';
    return text_append(buf, size, "%s", text != NULL ? text : "");
}

bool text_append(char *buf, size_t size, const char *format, ...) {
    const size_t used = strnlen(buf, size);
    assert(used < size);
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(buf + used, size - used, format, args);
    va_end(args);
    return n >= 0 && (size_t)n < size - used;
}

bool text_append_item(char *buf, size_t size, const char *item) {
    return text_append(buf, size, "%s%s", buf[0] != '\0' ? ", " : "", item);
}

bool text_list(char *buf, size_t size, const char *const *words) {
    bool fits = text_set(buf, size, "");
    for (; *words != NULL; words++)
        fits = text_append_item(buf, size, *words) && fits;
    return fits;
}

bool text_ends_with(const char *text, const char *end) {
    const size_t n = strlen(text);
    const size_t m = strlen(end);
    return n >= m && strcasecmp(text + n - m, end) == 0;
}

bool text_to_int64(const char *text, int64_t *value) {
    char *end = NULL;
    errno = 0;
    const long long number = strtoll(text, &end, 10);
    if (end == text || *end != '\0' || errno != 0)
        return false;
    *value = number;
    return true;
}

bool text_to_double(const char *text, double *value) {
    char *end = NULL;
    const double number = strtod(text, &end);
    if (end == text || *end != '\0')
        return false;
    *value = number;
    return true;
}

bool text_to_bool(const char *text, bool *value) {
    static const char *const words[] = {"false", "true", "no", "yes", "off", "on", "0", "1"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(words[i], text) == 0) {
            *value = i % 2 == 1;
            return true;
        }
    }
    return false;
}

int text_digits(double value, int least) {
    char text[40];
    for (int digits = least; digits < DBL_DECIMAL_DIG; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            return digits;
    }
    return DBL_DECIMAL_DIG;
}

void text_wrap(FILE *out, const char *text, int column, const char *indent) {
    bool fresh = true; /* nothing on this line yet */
    while (*text != '\0') {
        int length = (int)strcspn(text, " ");
        if (!fresh && column + 1 + length > TEXT_COLUMNS) {
            fprintf(out, "\n%s", indent);
            column = (int)strlen(indent);
            fresh = true;
        }
        column += fprintf(out, "%s%.*s", fresh ? "" : " ", length, text);
        fresh = false;
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}

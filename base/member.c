/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/member.h"

#include <math.h>
#include <string.h>

size_t member_size(enum member_type type) {
    static const size_t sizes[] = {
        [MEMBER_BOOL] = sizeof(bool),     [MEMBER_INT] = sizeof(int),
        [MEMBER_UNSIGNED] = sizeof(int),  [MEMBER_INT64] = sizeof(int64_t),
        [MEMBER_DOUBLE] = sizeof(double), [MEMBER_TEXT] = sizeof(char *),
    };
    return sizes[type];
}

static bool same_text(const char *a, const char *b) {
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

bool member_equal(enum member_type type, const void *a, const void *b) {
    member_value x = {0};
    member_value y = {0};
    memcpy(&x, a, member_size(type));
    memcpy(&y, b, member_size(type));
    switch (type) {
    case MEMBER_DOUBLE:
        return x.real == y.real || (isnan(x.real) && isnan(y.real));
    case MEMBER_TEXT:
        return same_text(x.text, y.text);
    default:
        return memcmp(&x, &y, member_size(type)) == 0;
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parse and format numbers: integers, bytes, durations and modes. A number is digits and, for bytes
 * and durations, a unit. */
#include "value.h"

#include <assert.h>
#include <inttypes.h>
#include <string.h>

typedef struct number_unit {
    const char *name;
    int64_t factor;
} number_unit;

/* Largest first, as number_format requires. */
static const number_unit byte_units[] = {{"T", INT64_C(1) << 40},
                                         {"G", INT64_C(1) << 30},
                                         {"M", INT64_C(1) << 20},
                                         {"K", INT64_C(1) << 10},
                                         {"", 1},
                                         {NULL, 0}};
static const number_unit time_units[] = {{"d", 86400000}, {"h", 3600000}, {"min", 60000},
                                         {"s", 1000},     {"ms", 1},      {NULL, 0}};
static const number_unit no_units[] = {{"", 1}, {NULL, 0}};

static const number_unit *units_of(const sheard_setting *s) {
    if (s->type == SHEARD_T_BYTES)
        return byte_units;
    return s->type == SHEARD_T_DURATION ? time_units : no_units;
}

/* Read the digits of a number in `base` at *text, and advance *text. Return false if there are
 * none. A number beyond int64 becomes INT64_MAX, which is out of every setting's range. */
static bool read_digits(const char **text, int base, int64_t *number) {
    const char *p = *text;
    int64_t n = 0;
    for (; *p >= '0' && *p < '0' + base; p++) {
        if (__builtin_mul_overflow(n, base, &n) || __builtin_add_overflow(n, *p - '0', &n))
            n = INT64_MAX;
    }
    bool some = p > *text;
    *text = p;
    *number = n;
    return some;
}

static const number_unit *find_unit(const sheard_setting *s, const char *name) {
    for (const number_unit *u = units_of(s); u->name != NULL; u++) {
        if (strcmp(u->name, name) == 0)
            return u;
    }
    return NULL;
}

/* Return whether `text` is a number of this type; *number is INT64_MAX if it is too large. */
static bool read_number(const sheard_setting *s, const char *text, int64_t *number) {
    int64_t n = 0;
    if (!read_digits(&text, s->type == SHEARD_T_MODE ? 8 : 10, &n))
        return false;
    const number_unit *u = find_unit(s, text);
    if (u == NULL)
        return false;
    if (__builtin_mul_overflow(n, u->factor, number))
        *number = INT64_MAX;
    return true;
}

char *number_format(const sheard_setting *s, int64_t number, char *buf, size_t size) {
    if (number == 0 && s->word != NULL) {
        snprintf(buf, size, "%s", s->word);
    } else if (s->type == SHEARD_T_MODE) {
        snprintf(buf, size, "%04" PRIo64, (uint64_t)number);
    } else if (number == 0) {
        snprintf(buf, size, "0%s", s->type == SHEARD_T_DURATION ? "s" : "");
    } else {
        const number_unit *u = units_of(s);
        while (number % u->factor != 0) {
            u++; /* the last factor is 1 */
        }
        assert(u->name != NULL);
        snprintf(buf, size, "%" PRId64 "%s", number / u->factor, u->name);
    }
    return buf;
}

bool number_parse(const sheard_setting *s, const char *text, int64_t *number) {
    int64_t n = 0;
    if (s->word != NULL && strcmp(text, s->word) == 0) {
        *number = 0;
        return true;
    }
    if (!read_number(s, text, &n) || n < s->min || n > s->max)
        return false;
    *number = n;
    return true;
}

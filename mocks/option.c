/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "option.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"
#include "value.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A type's numbers (none: it has no range), the mark between two of them, its size in the struct,
 * and the words for it. */
typedef struct option_type {
    int numbers;
    char mark;
    size_t size;
    const char *expected;
} option_type;

static const option_type types[] = {
    [SHEAR_MOCK_T_INT] = {1, '\0', sizeof(int), "a whole number"},
    [SHEAR_MOCK_T_COUNT] = {1, '\0', sizeof(int64_t), "a whole number"},
    [SHEAR_MOCK_T_SEED] = {0, '\0', sizeof(uint64_t),
                           "a whole number from 0 to 18446744073709551615"},
    [SHEAR_MOCK_T_DOUBLE] = {1, '\0', sizeof(double), "a number"},
    [SHEAR_MOCK_T_PAIR] = {2, ',', 2 * sizeof(double), "two numbers with a comma between"},
    [SHEAR_MOCK_T_SIZE] = {2, 'x', 2 * sizeof(int), "one whole number, or two with an x between"},
    [SHEAR_MOCK_T_CHOICE] = {0, '\0', sizeof(int), NULL}, /* the option's metavar */
    [SHEAR_MOCK_T_ON] = {0, '\0', sizeof(bool), "yes or no"},
    [SHEAR_MOCK_T_OFF] = {0, '\0', sizeof(bool), "yes or no"},
    [SHEAR_MOCK_T_TEXT] = {0, '\0', SHEAR_MOCK_TEXT_SIZE, "at most 68 printable ASCII characters"},
};

/* A value outside its struct, of any type. */
typedef union option_value {
    int64_t count;
    double number[2];
    char text[SHEAR_MOCK_TEXT_SIZE];
} option_value;

static const void *member(const void *spec, const shear_mock_option *o) {
    return (const char *)spec + o->offset;
}

static bool is_whole(const shear_mock_option *o) {
    return o->type == SHEAR_MOCK_T_INT || o->type == SHEAR_MOCK_T_SIZE;
}

static bool is_switch(const shear_mock_option *o) {
    return o->type == SHEAR_MOCK_T_ON || o->type == SHEAR_MOCK_T_OFF;
}

/* Return number i of the option's value at `m`. */
static double number(const void *m, const shear_mock_option *o, int i) {
    if (o->type == SHEAR_MOCK_T_COUNT)
        return (double)*(const int64_t *)m;
    return is_whole(o) ? ((const int *)m)[i] : ((const double *)m)[i];
}

static bool is_auto(const void *m, const shear_mock_option *o) {
    return o->has_auto && (is_whole(o) ? number(m, o, 0) == 0.0 : isnan(number(m, o, 0)));
}

static int check_choice(const void *m, const shear_mock_option *o, shear_error *err) {
    int value = *(const int *)m;
    int n = 0;
    while (o->choices[n] != NULL)
        n++;
    if (value < 0 || value >= n) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "mock option '%s': %d is not one of %s",
                          o->name, value, o->metavar);
    }
    return SHEAR_OK;
}

static int check_range(const void *m, const shear_mock_option *o, shear_error *err) {
    if (o->type == SHEAR_MOCK_T_CHOICE)
        return check_choice(m, o, err);
    for (int i = 0; i < types[o->type].numbers && !is_auto(m, o); i++) {
        const double v = number(m, o, i);
        if (!(v >= o->min && v <= o->max)) {
            return shear_fail(err, SHEAR_E_SETTING, NULL,
                              "mock option '%s': %.10g is not in the range from %g to %g%s",
                              o->name, v, o->min, o->max, o->has_auto ? ", or auto" : "");
        }
    }
    return SHEAR_OK;
}

int option_check_ranges(const option_table *t, const void *spec, shear_error *err) {
    for (size_t i = 0; i < t->n; i++)
        TRY(check_range(member(spec, &t->rows[i]), &t->rows[i], err));
    return SHEAR_OK;
}

const shear_mock_option *option_find(const option_table *t, const char *name) {
    for (size_t i = 0; i < t->n; i++) {
        if (strcmp(t->rows[i].name, name) == 0)
            return &t->rows[i];
    }
    return NULL;
}

static bool parse_number(const shear_mock_option *o, const char *text, void *m, int i) {
    return is_whole(o) ? value_int(text, (int *)m + i) : value_double(text, (double *)m + i);
}

/* Parse two numbers; one size is that of both sides. */
static bool parse_two(const shear_mock_option *o, const char *text, void *m) {
    char first[64];
    const bool fits = text_set(first, sizeof first, text);
    char *mark = strchr(first, types[o->type].mark);
    const char *second = mark != NULL ? mark + 1 : is_whole(o) ? first : "";
    if (mark != NULL)
        *mark = '\0';
    return fits && parse_number(o, first, m, 0) && parse_number(o, second, m, 1);
}

/* Parse `text` into the value at `m`. Returns false if it is not of the option's type. */
static bool parse(void *m, const shear_mock_option *o, const char *text) {
    bool yes = false;
    switch (o->type) {
    case SHEAR_MOCK_T_INT:
        *(int *)m = 0;
        break;
    case SHEAR_MOCK_T_DOUBLE:
        *(double *)m = NAN;
        break;
    case SHEAR_MOCK_T_COUNT:
        return value_int64(text, m);
    case SHEAR_MOCK_T_SEED:
        return value_uint64(text, m);
    case SHEAR_MOCK_T_CHOICE:
        *(int *)m = spelling_find(o->choices, text);
        return *(int *)m >= 0;
    case SHEAR_MOCK_T_TEXT:
        return value_copy(text, m, SHEAR_MOCK_TEXT_SIZE);
    case SHEAR_MOCK_T_PAIR:
    case SHEAR_MOCK_T_SIZE:
        return parse_two(o, text, m);
    default:
        if (!value_bool(text, &yes))
            return false;
        *(bool *)m = (o->type == SHEAR_MOCK_T_ON) == yes;
        return true;
    }
    return (o->has_auto && strcmp(text, "auto") == 0) || parse_number(o, text, m, 0);
}

int option_set(const option_table *t, void *spec, const char *name, const char *text,
               shear_error *err) {
    const shear_mock_option *o = option_find(t, name);
    if (o == NULL) {
        return shear_fail(err, SHEAR_E_SETTING, "\"shearctl help mock\" lists the options",
                          "there is no mock option '%s'", name);
    }
    const char *given = text != NULL ? text : is_switch(o) ? "yes" : "";
    option_value value = {.text = ""};
    if (!parse(&value, o, given)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "mock option '%s': \"%s\" is not %s%s",
                          o->name, given,
                          o->type == SHEAR_MOCK_T_CHOICE ? o->metavar : types[o->type].expected,
                          o->has_auto ? ", or auto" : "");
    }
    TRY(check_range(&value, o, err));
    memcpy((char *)spec + o->offset, &value, types[o->type].size);
    return SHEAR_OK;
}

char *option_format(const void *spec, const shear_mock_option *o, char *buf, size_t size) {
    const void *m = member(spec, o);
    char first[32];
    char second[32];
    if (o->type == SHEAR_MOCK_T_SEED) {
        snprintf(buf, size, "%" PRIu64, *(const uint64_t *)m);
    } else if (o->type == SHEAR_MOCK_T_CHOICE) {
        text_set(buf, size, o->choices[*(const int *)m]);
    } else if (o->type == SHEAR_MOCK_T_TEXT) {
        text_set(buf, size, m);
    } else if (is_switch(o)) {
        text_set(buf, size, *(const bool *)m == (o->type == SHEAR_MOCK_T_ON) ? "yes" : "no");
    } else if (types[o->type].numbers == 2) {
        snprintf(buf, size, "%s%c%s", value_of_double(number(m, o, 0), first), types[o->type].mark,
                 value_of_double(number(m, o, 1), second));
    } else {
        text_set(buf, size, is_auto(m, o) ? "auto" : value_of_double(number(m, o, 0), first));
    }
    return buf;
}

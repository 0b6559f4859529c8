/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Describe, format, compare and free values. */
#include "value.h"

#include "base/text.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* What the types of settings differ in. */
static const struct {
    const char *noun;        /* what a value is */
    const char *placeholder; /* for a value, in usages */
    enum member_type member; /* C type of the member, if it is not a list */
    bool is_list;
} kinds[] = {
    [SHEARD_T_PATH] = {"an absolute path", "PATH", MEMBER_TEXT, false},
    [SHEARD_T_NAME] = {"a name, or empty", "VALUE", MEMBER_TEXT, false},
    [SHEARD_T_PATHS] = {"absolute paths, separated by commas", "PATH,...", 0, true},
    [SHEARD_T_NAMES] = {"names, separated by commas", "VALUE", 0, true},
    [SHEARD_T_INT] = {"a whole number", "N", MEMBER_INT64, false},
    [SHEARD_T_BYTES] = {"a size (as in 512K, 64M, 4G)", "VALUE", MEMBER_INT64, false},
    [SHEARD_T_DURATION] = {"a duration with its unit (as in 250ms, 30s, 5min, 2h, 7d)", "TIME",
                           MEMBER_INT64, false},
    [SHEARD_T_MODE] = {"an octal mode", "VALUE", MEMBER_UNSIGNED, false},
    [SHEARD_T_CHOICE] = {"one of: ", "VALUE", MEMBER_INT, false},
    [SHEARD_T_BOOL] = {"true or false", "VALUE", MEMBER_BOOL, false},
    [SHEARD_T_MEASURE] = {NULL, "VALUE", 0, false},
};

bool value_is_list(const sheard_setting *s) {
    return kinds[s->type].is_list;
}

static enum member_type member_type(const sheard_setting *s) {
    assert(!value_is_list(s) && s->type != SHEARD_T_MEASURE);
    return kinds[s->type].member;
}

size_t value_size(const sheard_setting *s) {
    return value_is_list(s) ? sizeof(sheard_list) : member_size(member_type(s));
}

const char *value_placeholder(const sheard_setting *s) {
    return kinds[s->type].placeholder;
}

char *value_expected(const sheard_setting *s, char *buf, size_t size) {
    text_set(buf, size, kinds[s->type].noun);
    if (s->unit != NULL)
        text_append(buf, size, " of %s", s->unit);
    if (s->choices != NULL)
        text_list(buf + strlen(buf), size - strlen(buf), s->choices);
    const bool is_number = s->max > 0 && !value_is_list(s) && member_type(s) != MEMBER_TEXT;
    if (is_number) {
        char low[32];
        char high[32];
        sheard_setting plain = *s; /* bounds are printed as numbers, never as the word for 0 */
        plain.word = NULL;
        text_append(buf, size, " from %s to %s", number_format(&plain, s->min, low, sizeof low),
                    number_format(&plain, s->max, high, sizeof high));
    }
    if (s->word != NULL)
        text_append(buf, size, ", or %s", s->word);
    return buf;
}

static char *format_number(const sheard_setting *s, int64_t number) {
    char buf[VALUE_TEXT_MAX];
    return strdup(number_format(s, number, buf, sizeof buf));
}

char *value_format(const sheard_setting *s, const void *member) {
    if (value_is_list(s))
        return sheard_list_join(member);
    switch (s->type) {
    case SHEARD_T_PATH:
    case SHEARD_T_NAME:
        return strdup(*(char *const *)member);
    case SHEARD_T_CHOICE:
        return strdup(s->choices[*(const int *)member]);
    case SHEARD_T_BOOL:
        return strdup(*(const bool *)member ? "true" : "false");
    case SHEARD_T_MODE:
        return format_number(s, *(const unsigned *)member);
    default:
        return format_number(s, *(const int64_t *)member);
    }
}

static bool same_list(const sheard_list *a, const sheard_list *b) {
    if (a->n != b->n)
        return false;
    for (size_t i = 0; i < a->n; i++) {
        if (strcmp(a->items[i], b->items[i]) != 0)
            return false;
    }
    return true;
}

bool value_equal(const sheard_setting *s, const void *a, const void *b) {
    return value_is_list(s) ? same_list(a, b) : member_equal(member_type(s), a, b);
}

void value_deinit(const sheard_setting *s, void *member) {
    if (value_is_list(s)) {
        sheard_list_deinit(member);
    } else if (member_type(s) == MEMBER_TEXT) {
        free(*(char **)member);
        *(char **)member = NULL;
    }
}

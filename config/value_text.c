/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Format, compare and free values. */
#include "value.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

bool value_is_list(const sheard_setting *s) {
    return s->type == SHEARD_T_PATHS || s->type == SHEARD_T_NAMES;
}

enum member_type value_member_type(const sheard_setting *s) {
    static const enum member_type types[] = {
        [SHEARD_T_PATH] = MEMBER_TEXT,     [SHEARD_T_NAME] = MEMBER_TEXT,
        [SHEARD_T_INT] = MEMBER_INT64,     [SHEARD_T_BYTES] = MEMBER_INT64,
        [SHEARD_T_MODE] = MEMBER_UNSIGNED, [SHEARD_T_DURATION] = MEMBER_INT64,
        [SHEARD_T_CHOICE] = MEMBER_INT,    [SHEARD_T_BOOL] = MEMBER_BOOL,
    };
    assert(!value_is_list(s) && s->type != SHEARD_T_MEASURE);
    return types[s->type];
}

size_t value_size(const sheard_setting *s) {
    return value_is_list(s) ? sizeof(sheard_list) : member_size(value_member_type(s));
}

static char *join(const sheard_list *list) {
    size_t size = 1;
    for (size_t i = 0; i < list->n; i++)
        size += strlen(list->items[i]) + 2;
    char *text = malloc(size);
    if (text == NULL)
        return NULL;
    char *to = text;
    for (size_t i = 0; i < list->n; i++) {
        to = stpcpy(to, i > 0 ? ", " : "");
        to = stpcpy(to, list->items[i]);
    }
    *to = '\0';
    return text;
}

static char *format_number(const sheard_setting *s, int64_t number) {
    char buf[VALUE_TEXT_MAX];
    return strdup(number_format(s, number, buf, sizeof buf));
}

char *value_format(const sheard_setting *s, const void *member) {
    if (value_is_list(s))
        return join(member);
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
    return value_is_list(s) ? same_list(a, b) : member_equal(value_member_type(s), a, b);
}

void value_deinit(const sheard_setting *s, void *member) {
    if (value_is_list(s)) {
        sheard_list_deinit(member);
    } else if (value_member_type(s) == MEMBER_TEXT) {
        free(*(char **)member);
        *(char **)member = NULL;
    }
}

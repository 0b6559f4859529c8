/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What else can be done with a value: write, compare, release. */
#include "value.h"

#include <stdlib.h>
#include <string.h>

static char *join(const sheard_list *list) {
    size_t size = 1;
    for (size_t i = 0; i < list->n; i++) {
        size += strlen(list->items[i]) + 2;
    }
    char *text = malloc(size);
    if (text == NULL) {
        return NULL;
    }
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
    switch (s->type) {
    case SHEARD_T_PATH:
    case SHEARD_T_NAME:
        return strdup(*(char *const *)member);
    case SHEARD_T_PATHS:
    case SHEARD_T_NAMES:
        return join(member);
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
    if (a->n != b->n) {
        return false;
    }
    for (size_t i = 0; i < a->n; i++) {
        if (strcmp(a->items[i], b->items[i]) != 0) {
            return false;
        }
    }
    return true;
}

bool value_equal(const sheard_setting *s, const void *a, const void *b) {
    switch (s->type) {
    case SHEARD_T_PATH:
    case SHEARD_T_NAME:
        return strcmp(*(char *const *)a, *(char *const *)b) == 0;
    case SHEARD_T_PATHS:
    case SHEARD_T_NAMES:
        return same_list(a, b);
    case SHEARD_T_CHOICE:
        return *(const int *)a == *(const int *)b;
    case SHEARD_T_BOOL:
        return *(const bool *)a == *(const bool *)b;
    case SHEARD_T_MODE:
        return *(const unsigned *)a == *(const unsigned *)b;
    default:
        return *(const int64_t *)a == *(const int64_t *)b;
    }
}

void value_deinit(const sheard_setting *s, void *member) {
    if (s->type == SHEARD_T_PATH || s->type == SHEARD_T_NAME) {
        free(*(char **)member);
        *(char **)member = NULL;
    } else if (s->type == SHEARD_T_PATHS || s->type == SHEARD_T_NAMES) {
        sheard_list_deinit(member);
    }
}

size_t value_size(const sheard_setting *s) {
    switch (s->type) {
    case SHEARD_T_PATH:
    case SHEARD_T_NAME:
        return sizeof(char *);
    case SHEARD_T_PATHS:
    case SHEARD_T_NAMES:
        return sizeof(sheard_list);
    case SHEARD_T_CHOICE:
        return sizeof(int);
    case SHEARD_T_BOOL:
        return sizeof(bool);
    case SHEARD_T_MODE:
        return sizeof(unsigned);
    default:
        return sizeof(int64_t);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/member.h: typed members of structs, by offset, for tables that describe a struct (settings,
 * messages). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The offset of a member that must have this type: otherwise it does not compile. (A type's name in
 * sizeof cannot be put in parentheses.) */
/* clang-format off */
#define MEMBER_AT(T, member, type)                                                                 \
    (offsetof(T, member) +                                                                         \
     0 * sizeof(char[_Generic(((T *)0)->member, type: 1, default: -1)])) /* NOLINT(bugprone-macro-parentheses) */
/* clang-format on */

enum member_type {
    MEMBER_BOOL,     /* bool */
    MEMBER_INT,      /* int, or an enum with a negative enumerator */
    MEMBER_UNSIGNED, /* unsigned */
    MEMBER_INT64,    /* int64_t */
    MEMBER_DOUBLE,   /* double */
    MEMBER_TEXT      /* char * */
};

/* A value of any of these types. All members begin at the union's address. */
typedef union member_value {
    bool flag;
    int number;
    unsigned bits;
    int64_t count;
    double real;
    char *text;
} member_value;

size_t member_size(enum member_type type);

/* Return whether two members are equal. NaN equals NaN, texts are compared byte by byte, and NULL
 * equals only NULL. */
bool member_equal(enum member_type type, const void *a, const void *b);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* warnings.h: the warnings about one field's result, kept for its report and printed to standard
 * error. */
#pragma once

#include <stddef.h>

typedef struct warning_list {
    char **text; /* [n], owned */
    size_t n, capacity;
} warning_list;

/* Add one line. If out of memory, print it at once instead. */
void warnings_add(warning_list *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Print all warnings to standard error, each after "field NAME: ". */
void warnings_print(const warning_list *w, const char *field);
void warnings_deinit(warning_list *w);

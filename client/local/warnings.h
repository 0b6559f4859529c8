/* SPDX-License-Identifier: GPL-3.0-or-later */
/* warnings.h: the warnings that belong to one field's result: kept for its report, shown on
 * standard error. */
#ifndef CLIENT_LOCAL_WARNINGS_H
#define CLIENT_LOCAL_WARNINGS_H

#include <stddef.h>

typedef struct warning_list {
    char **text; /* [n], owned */
    size_t n, capacity;
} warning_list;

/* Add one line. When memory is out it is printed at once and not kept. */
void warnings_add(warning_list *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Print all to standard error, after "field NAME: ". */
void warnings_print(const warning_list *w, const char *field);
void warnings_deinit(warning_list *w);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_table.h: tables of text. On a terminal they have colours and are cut to its width; otherwise
 * they are complete and plain. Characters that are not printable are shown as '?'. */
#pragma once

#include "base/cleanup.h"
#include "terminal/exit_code.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct text_table text_table;

typedef struct text_column {
    const char *title;
    char align; /* 'l' or 'r' */
} text_column;

/* Create a table. `columns` is not copied. Returns NULL if out of memory; all functions accept
 * NULL. */
text_table *text_table_new(const text_column *columns, size_t n_columns);
void text_table_free(text_table *table);
CLEANUP_DEFINE(text_table, text_table_free)

/* Add the next cell, row by row. `style` is one of style.h, or NULL. */
void text_table_cell(text_table *table, const char *style, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Print titles and all rows. Returns an exit code; if out of memory, an error has been printed. */
enum exit_code text_table_print(const text_table *table, FILE *out);
/* Do the same with `indent` spaces before each row, with or without colours, at most `columns` wide
 * (0: no limit). */
enum exit_code text_table_render(const text_table *table, FILE *out, int indent, bool colours,
                                 int columns);
/* Return whether the table is complete, without a row. */
bool text_table_is_empty(const text_table *table);

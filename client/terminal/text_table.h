/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_table.h: rows and columns of text. On a terminal with colours, and cut to its width;
 * elsewhere whole and plain. What is not printable in a cell is shown as '?'. */
#ifndef CLIENT_TERMINAL_TEXT_TABLE_H
#define CLIENT_TERMINAL_TEXT_TABLE_H

#include "terminal/exit_code.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct text_table text_table;

typedef struct text_column {
    const char *title;
    char align; /* 'l' or 'r' */
} text_column;

/* `columns` is kept, not copied. NULL when memory is out: all calls accept it. */
text_table *text_table_new(const text_column *columns, size_t n_columns);
void text_table_free(text_table *table);

/* Add the next cell, row by row. `style` is one of style.h or NULL. */
void text_table_cell(text_table *table, const char *style, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Titles and all rows. Returns an exit code: an error is printed where memory was missing. */
enum exit_code text_table_print(const text_table *table, FILE *out);
/* The same with `indent` spaces before each row, colours as told, and at most `columns` wide (0:
 * any width). */
enum exit_code text_table_render(const text_table *table, FILE *out, int indent, bool colours,
                                 int columns);
size_t text_table_rows(const text_table *table);

#endif

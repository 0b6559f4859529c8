/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/text_table.h"

#include "terminal/message.h"
#include "terminal/style.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <assert.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CELL_MAX = 4200, GAP = 2, MAX_COLUMNS = 16 }; /* bytes of a cell: a path fits */

typedef struct table_cell {
    char *text;
    const char *style;
    int width;
} table_cell;

struct text_table {
    const text_column *columns;
    size_t n_columns;
    table_cell *cells; /* [n], row by row */
    size_t n, capacity;
    bool failed; /* out of memory */
};

text_table *text_table_new(const text_column *columns, size_t n_columns) {
    text_table *t = calloc(1, sizeof *t);
    if (t != NULL) {
        t->columns = columns;
        t->n_columns = n_columns;
    }
    return t;
}

void text_table_free(text_table *t) {
    if (t == NULL)
        return;
    for (size_t i = 0; i < t->n; i++)
        free(t->cells[i].text);
    free(t->cells);
    free(t);
}

void text_table_cell(text_table *t, const char *style, const char *format, ...) {
    char text[CELL_MAX];
    char clean[CELL_MAX];
    if (t == NULL || t->failed)
        return;
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    char *copy = strdup(message_clean(text, clean, sizeof clean));
    if (copy == NULL || !ARRAY_RESERVE(t->cells, t->capacity, t->n + 1)) {
        free(copy);
        t->failed = true;
        return;
    }
    t->cells[t->n++] = (table_cell){copy, style, style_width(copy)};
}

static int column_width(const text_table *t, size_t column) {
    int width = style_width(t->columns[column].title);
    for (size_t i = column; i < t->n; i += t->n_columns)
        width = t->cells[i].width > width ? t->cells[i].width : width;
    return width;
}

/* Print one cell with its padding; none after the last column. */
static void put(FILE *line, const char *text, const char *style, int padding, char align,
                bool last) {
    if (align == 'r')
        fprintf(line, "%*s", padding, "");
    fprintf(line, "%s%s%s", style != NULL ? style : "", text, style != NULL ? STYLE_END : "");
    if (align != 'r' && !last)
        fprintf(line, "%*s", padding, "");
    if (!last)
        fprintf(line, "%*s", GAP, "");
}

/* Compose a row; the titles if `cells` is NULL. */
static void compose(const text_table *t, const table_cell *cells, const int *widths, bool colours,
                    FILE *line) {
    for (size_t i = 0; i < t->n_columns; i++) {
        const char *text = cells != NULL ? cells[i].text : t->columns[i].title;
        const char *style = cells != NULL ? cells[i].style : STYLE_BOLD;
        put(line, text, colours ? style : NULL, widths[i] - style_width(text), t->columns[i].align,
            i + 1 == t->n_columns);
    }
}

/* The layout of a table. */
typedef struct table_layout {
    int widths[MAX_COLUMNS]; /* of the columns */
    int indent, columns;     /* of the whole table; columns 0: no limit */
    bool colours;
} table_layout;

/* Print a row; the titles if `cells` is NULL. Returns false if out of memory. */
static bool print_row(const text_table *t, const table_cell *cells, const table_layout *l,
                      FILE *out) {
    CLEANUP(release_free) char *text = NULL;
    size_t size = 0;
    FILE *line = open_memstream(&text, &size);
    if (line == NULL)
        return false;
    fprintf(line, "%*s", l->indent, "");
    compose(t, cells, l->widths, l->colours, line);
    if (fclose(line) != 0 || text == NULL)
        return false;
    size_t n = l->columns > 0 ? style_fit(text, l->columns) : strlen(text);
    while (n > 0 && text[n - 1] == ' ') { /* from empty cells at the end */
        n--;
    }
    fprintf(out, "%.*s%s\n", (int)n, text, l->colours ? STYLE_END : "");
    return true;
}

enum exit_code text_table_render(const text_table *t, FILE *out, int indent, bool colours,
                                 int columns) {
    if (t == NULL || t->failed)
        return message_no_memory();
    table_layout l = {.indent = indent, .columns = columns, .colours = colours};
    assert(t->n_columns <= MAX_COLUMNS && t->n % t->n_columns == 0);
    for (size_t i = 0; i < t->n_columns; i++)
        l.widths[i] = column_width(t, i);
    bool good = print_row(t, NULL, &l, out);
    for (size_t i = 0; good && i < t->n; i += t->n_columns)
        good = print_row(t, t->cells + i, &l, out);
    return good ? EXIT_CODE_DONE : message_no_memory();
}

enum exit_code text_table_print(const text_table *t, FILE *out) {
    return text_table_render(t, out, 0, style_on(out), style_columns(fileno(out), 0));
}

bool text_table_is_empty(const text_table *t) {
    return t != NULL && !t->failed && t->n == 0;
}

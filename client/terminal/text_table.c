/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/text_table.h"

#include "cmdline/command.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CELL_MAX = 4200, GAP = 2 }; /* bytes; a path fits */

typedef struct table_cell {
    char *text;
    const char *style;
    int width;
} table_cell;

typedef struct text_table {
    const text_column *columns;
    size_t n_columns;
    table_cell *cells; /* [n], row by row */
    size_t n, room;
    bool failed; /* no memory */
} text_table;

text_table *text_table_new(const text_column *columns, size_t n_columns) {
    text_table *t = calloc(1, sizeof *t);
    if (t != NULL) {
        t->columns = columns;
        t->n_columns = n_columns;
    }
    return t;
}

void text_table_free(text_table *t) {
    if (t == NULL) {
        return;
    }
    for (size_t i = 0; i < t->n; i++) {
        free(t->cells[i].text);
    }
    free(t->cells);
    free(t);
}

static bool make_room(text_table *t) {
    if (t->n < t->room) {
        return true;
    }
    const size_t room = t->room != 0 ? 2 * t->room : 64;
    table_cell *cells = reallocarray(t->cells, room, sizeof *cells);
    if (cells != NULL) {
        t->cells = cells;
        t->room = room;
    }
    return cells != NULL;
}

void text_table_cell(text_table *t, const char *style, const char *format, ...) {
    char text[CELL_MAX];
    char clean[CELL_MAX];
    if (t == NULL || t->failed) {
        return;
    }
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    char *copy = strdup(message_clean(text, clean, sizeof clean));
    if (copy == NULL || !make_room(t)) {
        free(copy);
        t->failed = true;
        return;
    }
    t->cells[t->n++] = (table_cell){copy, style, style_width(copy)};
}

static int column_width(const text_table *t, size_t column) {
    int width = style_width(t->columns[column].title);
    for (size_t i = column; i < t->n; i += t->n_columns) {
        width = t->cells[i].width > width ? t->cells[i].width : width;
    }
    return width;
}

/* One cell with its padding; none behind the last column. */
static void put(FILE *line, const char *text, const char *style, int padding, char align,
                bool last) {
    if (align == 'r') {
        fprintf(line, "%*s", padding, "");
    }
    fprintf(line, "%s%s%s", style != NULL ? style : "", text, style != NULL ? STYLE_END : "");
    if (align != 'r' && !last) {
        fprintf(line, "%*s", padding, "");
    }
    if (!last) {
        fprintf(line, "%*s", GAP, "");
    }
}

/* `cells` NULL: the titles. */
static void compose(const text_table *t, const table_cell *cells, const int *widths, bool colours,
                    FILE *line) {
    for (size_t i = 0; i < t->n_columns; i++) {
        const char *text = cells != NULL ? cells[i].text : t->columns[i].title;
        const char *style = cells != NULL ? cells[i].style : STYLE_BOLD;
        put(line, text, colours ? style : NULL, widths[i] - style_width(text), t->columns[i].align,
            i + 1 == t->n_columns);
    }
}

static bool print_row(const text_table *t, const table_cell *cells, const int *widths, FILE *out,
                      int indent, bool colours, int columns) {
    char *text = NULL;
    size_t size = 0;
    FILE *line = open_memstream(&text, &size);
    if (line == NULL) {
        return false;
    }
    fprintf(line, "%*s", indent, "");
    compose(t, cells, widths, colours, line);
    const bool good = fclose(line) == 0 && text != NULL;
    if (good) {
        size_t n = columns > 0 ? style_fit(text, columns) : strlen(text);
        while (n > 0 && text[n - 1] == ' ') { /* of empty cells at the end */
            n--;
        }
        fprintf(out, "%.*s%s\n", (int)n, text, colours ? STYLE_END : "");
    }
    free(text);
    return good;
}

int text_table_render(const text_table *t, FILE *out, int indent, int colours, int columns) {
    enum { MAX_COLUMNS = 16 };
    int widths[MAX_COLUMNS];
    bool good = t != NULL && !t->failed && t->n_columns <= MAX_COLUMNS;
    for (size_t i = 0; good && i < t->n_columns; i++) {
        widths[i] = column_width(t, i);
    }
    good = good && print_row(t, NULL, widths, out, indent, colours != 0, columns);
    for (size_t i = 0; good && i + t->n_columns <= t->n; i += t->n_columns) {
        good = print_row(t, t->cells + i, widths, out, indent, colours != 0, columns);
    }
    if (!good) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    return EXIT_CODE_DONE;
}

int text_table_print(const text_table *t, FILE *out) {
    return text_table_render(t, out, 0, style_on(out), style_columns(fileno(out), 0));
}

size_t text_table_rows(const text_table *t) {
    return t != NULL ? t->n / t->n_columns : 0;
}

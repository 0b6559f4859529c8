/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table.h"

#include "base/array.h"
#include "base/text.h"
#include "engine/must.h"
#include "shear.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_COLUMNS = 40, MAX_META = 48, MAX_TEXT = 1100, MAX_CELL = 48 };

/* The column as given; its name is made from that of `of`. */
typedef struct made_column {
    const column *of;
    char name[MAX_CELL];
    const char *help;
    int width;
} made_column;

/* A value for people and for programs. */
typedef struct cell {
    char text[MAX_CELL], exact[MAX_CELL];
} cell;

typedef struct meta {
    char key[MAX_CELL];
    char text[MAX_TEXT];
} meta;

struct table {
    int n_columns, n_meta;
    size_t n, capacity; /* cells */
    cell *cells;
    made_column columns[MAX_COLUMNS];
    meta meta[MAX_META];
};

/* ---- filling ---- */

table *table_new(const options *o) {
    table *t = must_allocate(1, sizeof *t, "a table");
    CLEANUP(release_free)
    char *settings = options_describe(o); /* "name value" lines become one string */
    for (char *p = strchr(settings, '\n'); p != NULL; p = strchr(p, '\n'))
        *p = p[1] != '\0' ? ';' : '\0';
    table_meta(t, "experiment", "%s", o->experiment->name);
    table_meta(t, "command", "%s", o->command);
    table_meta(t, "version", "sheard %s", shear_version());
    table_meta(t, "settings", "%s", settings);
    return t;
}

void table_free(table *t) {
    free(t->cells);
    free(t);
}

static void add_column(table *t, const column *of, const char *suffix, const char *help,
                       char component) {
    assert(t->n_columns < MAX_COLUMNS && t->n == 0);
    made_column *c = &t->columns[t->n_columns++];
    *c = (made_column){.of = of, .help = help};
    c->width = snprintf(c->name, sizeof c->name, "%s%s", of->name, suffix);
    char *mark = strchr(c->name, '#');
    if (mark != NULL)
        *mark = component;
}

static void add_with_error(table *t, const column *c, char component) {
    add_column(t, c, "", c->help, component);
    if (c->with_error)
        add_column(t, c, "_err", "its 1-sigma error", component);
}

void table_columns(table *t, const column *columns) {
    for (const column *c = columns; c->name != NULL;) {
        int n = 0; /* columns of each component */
        while (c[n].name != NULL && strchr(c[n].name, '#') != NULL)
            n++;
        for (int i = 0; i < 2 * n; i++)
            add_with_error(t, &c[i % n], i < n ? '1' : '2');
        if (n == 0)
            add_with_error(t, c, '#');
        c += n > 0 ? n : 1;
    }
}

/* Return the column of the next cell. */
static made_column *next_column(table *t) {
    return &t->columns[t->n % (size_t)t->n_columns];
}

static void add_cell(table *t, const char *text, const char *exact) {
    made_column *c = next_column(t);
    const int width = (int)strlen(text);
    if (!ARRAY_RESERVE(t->cells, t->capacity, t->n + 1))
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for a table");
    cell *next = &t->cells[t->n++];
    text_set(next->text, sizeof next->text, text);
    text_set(next->exact, sizeof next->exact, exact);
    c->width = width > c->width ? width : c->width;
}

/* Format a number for the printed table. */
static void format_cell(const column *c, double value, char *buf) {
    if (isnan(value)) {
        snprintf(buf, MAX_CELL, "-");
    } else if (c->kind == TABLE_INTEGER) {
        snprintf(buf, MAX_CELL, "%.0f", value);
    } else if (c->digits < 0) {
        snprintf(buf, MAX_CELL, "%.*g", -c->digits, value);
    } else {
        snprintf(buf, MAX_CELL, "%.*f", c->digits, value);
    }
}

void table_add_numbers(table *t, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        const column *c = next_column(t)->of;
        char text[MAX_CELL];
        char exact[MAX_CELL];
        assert(c->kind != TABLE_TEXT);
        format_cell(c, values[i], text);
        snprintf(exact, sizeof exact, c->kind == TABLE_INTEGER ? "%.0f" : "%.10g", values[i]);
        add_cell(t, text, exact);
    }
}

void table_add_texts(table *t, size_t n, const char *const *texts) {
    for (size_t i = 0; i < n; i++) {
        char quoted[MAX_CELL];
        assert(next_column(t)->of->kind == TABLE_TEXT);
        snprintf(quoted, sizeof quoted, "\"%s\"", texts[i]);
        add_cell(t, texts[i], quoted);
    }
}

void table_meta(table *t, const char *key, const char *format, ...) {
    assert(t->n_meta < MAX_META);
    meta *m = &t->meta[t->n_meta++];
    va_list args;
    va_start(args, format);
    text_set(m->key, sizeof m->key, key);
    vsnprintf(m->text, sizeof m->text, format, args);
    va_end(args);
}

/* ---- writing ---- */

static const char *end_of(const table *t, size_t i_cell, const char *between) {
    return (i_cell + 1) % (size_t)t->n_columns != 0 ? between : "\n";
}

static void print_padded(const table *t, size_t i_cell, const char *text, FILE *out) {
    const made_column *c = &t->columns[i_cell % (size_t)t->n_columns];
    fprintf(out, "%*s%s", c->of->kind == TABLE_TEXT ? -c->width : c->width, text,
            end_of(t, i_cell, "  "));
}

void table_print(const table *t, FILE *out) {
    for (int i = 0; i < t->n_columns; i++)
        print_padded(t, (size_t)i, t->columns[i].name, out);
    for (size_t i = 0; i < t->n; i++)
        print_padded(t, i, t->cells[i].text, out);
    for (int i = 0; i < t->n_meta; i++) {
        if (strcmp(t->meta[i].key, TABLE_CONCLUSION) == 0)
            fprintf(out, "%s\n", t->meta[i].text);
    }
}

/* Write a YAML scalar in single quotes. */
static void write_yaml(FILE *out, const char *text) {
    fputc('\'', out);
    for (; *text != '\0'; text++)
        fputs(*text == '\'' ? "''" : (char[]){*text, '\0'}, out);
    fputc('\'', out);
}

static void write_columns(const table *t, FILE *out) {
    static const char *const types[] = {"float64", "int64", "string"};
    fputs("# %ECSV 1.0\n# ---\n# datatype:\n", out);
    for (int i = 0; i < t->n_columns; i++) {
        const made_column *c = &t->columns[i];
        fprintf(out, "# - {name: %s, ", c->name);
        if (c->of->unit != NULL)
            fprintf(out, "unit: %s, ", c->of->unit);
        fprintf(out, "datatype: %s, description: ", types[c->of->kind]);
        write_yaml(out, c->help);
        fputs("}\n", out);
    }
}

/* Write the metadata. A repeated key gets a number appended. */
static void write_meta(const table *t, FILE *out) {
    fputs("# meta: !!omap\n", out);
    for (int i = 0; i < t->n_meta; i++) {
        int number = 1;
        for (int k = 0; k < i; k++)
            number += strcmp(t->meta[k].key, t->meta[i].key) == 0;
        fprintf(out, "# - %s", t->meta[i].key);
        if (number > 1)
            fprintf(out, "%d", number);
        fputs(": ", out);
        write_yaml(out, t->meta[i].text);
        fputc('\n', out);
    }
}

static void write_ecsv(const table *t, FILE *out) {
    write_columns(t, out);
    write_meta(t, out);
    fputs("# schema: astropy-2.0\n", out);
    for (int i = 0; i < t->n_columns; i++)
        fprintf(out, "%s%s", t->columns[i].name, end_of(t, (size_t)i, " "));
    for (size_t i = 0; i < t->n; i++)
        fprintf(out, "%s%s", t->cells[i].exact, end_of(t, i, " "));
}

static _Noreturn void fail(const char *path) {
    must_fail(SHEAR_E_IO, NULL, "cannot write '%s': %s", path, strerror(errno));
}

void table_save(const table *t, const options *o) {
    char path[OPTIONS_PATH];
    char part[OPTIONS_PATH + 8];
    options_path(o, NULL, "ecsv", path);
    snprintf(part, sizeof part, "%s.part", path);
    FILE *out = fopen(part, "w");
    if (out == NULL)
        fail(part);
    write_ecsv(t, out);
    const bool failed = ferror(out) != 0;
    if (fclose(out) != 0 || failed || rename(part, path) != 0)
        fail(path);
}

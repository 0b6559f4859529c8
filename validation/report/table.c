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

typedef struct cell {
    double number;
    char text[MAX_CELL];
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
    char *settings = options_describe(o); /* "name value" lines become one string */
    for (char *p = strchr(settings, '\n'); p != NULL; p = strchr(p, '\n'))
        *p = p[1] != '\0' ? ';' : '\0';
    table_meta(t, "experiment", "%s", o->experiment->name);
    table_meta(t, "command", "%s", o->command);
    table_meta(t, "version", "sheard %s", shear_version());
    table_meta(t, "settings", "%s", settings);
    free(settings);
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

static void add_columns(table *t, const column *columns, char component) {
    for (const column *c = columns; c->name != NULL; c++) {
        add_column(t, c, "", c->help, component);
        if (c->with_error)
            add_column(t, c, "_err", "its 1-sigma error", component);
    }
}

void table_columns(table *t, const column *columns) {
    add_columns(t, columns, '#');
}

void table_components(table *t, const column *columns) {
    add_columns(t, columns, '1');
    add_columns(t, columns, '2');
}

static cell *next_cell(table *t, made_column **c) {
    if (!ARRAY_RESERVE(t->cells, t->capacity, t->n + 1))
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for a table");
    *c = &t->columns[t->n % (size_t)t->n_columns];
    return &t->cells[t->n++];
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

static void widen(made_column *c, const char *text) {
    const int width = (int)strlen(text);
    c->width = width > c->width ? width : c->width;
}

void table_add_numbers(table *t, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        made_column *c = NULL;
        cell *next = next_cell(t, &c);
        assert(c->of->kind != TABLE_TEXT);
        next->number = values[i];
        format_cell(c->of, values[i], next->text);
        widen(c, next->text);
    }
}

void table_add_texts(table *t, size_t n, const char *const *texts) {
    for (size_t i = 0; i < n; i++) {
        made_column *c = NULL;
        cell *next = next_cell(t, &c);
        assert(c->of->kind == TABLE_TEXT);
        text_set(next->text, sizeof next->text, texts[i]);
        widen(c, next->text);
    }
}

__attribute__((format(printf, 3, 0))) static void add_meta(table *t, const char *key,
                                                           const char *format, va_list args) {
    assert(t->n_meta < MAX_META);
    meta *m = &t->meta[t->n_meta++];
    snprintf(m->key, sizeof m->key, "%s", key);
    vsnprintf(m->text, sizeof m->text, format, args);
}

void table_meta(table *t, const char *key, const char *format, ...) {
    va_list args;
    va_start(args, format);
    add_meta(t, key, format, args);
    va_end(args);
}

void table_conclude(table *t, const char *format, ...) {
    va_list args;
    va_start(args, format);
    add_meta(t, "verdict", format, args);
    va_end(args);
}

/* ---- writing ---- */

/* Writes one cell; the cells of a row are written in order, with `between` them. */
typedef void cell_writer(FILE *out, const made_column *c, const cell *value);
static void write_rows(const table *t, FILE *out, const char *between, cell_writer *write) {
    for (size_t k = 0; k < t->n; k++) {
        const int i = (int)(k % (size_t)t->n_columns);
        write(out, &t->columns[i], &t->cells[k]);
        fputs(i + 1 < t->n_columns ? between : "\n", out);
    }
}

static void write_padded(FILE *out, const made_column *c, const char *text) {
    fprintf(out, "%*s", c->of->kind == TABLE_TEXT ? -c->width : c->width, text);
}

static void write_for_people(FILE *out, const made_column *c, const cell *value) {
    write_padded(out, c, value->text);
}

void table_print(const table *t, FILE *out) {
    for (int i = 0; i < t->n_columns; i++) {
        write_padded(out, &t->columns[i], t->columns[i].name);
        fputs(i + 1 < t->n_columns ? "  " : "\n", out);
    }
    write_rows(t, out, "  ", write_for_people);
    for (int i = 0; i < t->n_meta; i++) {
        if (strcmp(t->meta[i].key, "verdict") == 0)
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

static void write_for_programs(FILE *out, const made_column *c, const cell *value) {
    if (c->of->kind == TABLE_TEXT) {
        fprintf(out, "\"%s\"", value->text);
    } else if (c->of->kind == TABLE_INTEGER) {
        fprintf(out, "%.0f", value->number);
    } else {
        fprintf(out, "%.10g", value->number);
    }
}

static void write_ecsv(const table *t, FILE *out) {
    write_columns(t, out);
    write_meta(t, out);
    fputs("# schema: astropy-2.0\n", out);
    for (int i = 0; i < t->n_columns; i++)
        fprintf(out, "%s%s", t->columns[i].name, i + 1 < t->n_columns ? " " : "\n");
    write_rows(t, out, " ", write_for_programs);
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table.h"

#include "engine/experiment.h"
#include "shear.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_COLUMNS = 40, MAX_META = 40, MAX_TEXT = 1100, MAX_CELL = 48 };

struct column {
    char name[MAX_CELL];
    int kind, digits;
    char unit[16];
    char help[160];
    int width;
};

struct cell {
    double number;
    char text[MAX_CELL];
};

typedef struct meta {
    char key[MAX_CELL];
    char text[MAX_TEXT];
} meta;

struct table {
    int n_columns, n_meta;
    size_t n, room; /* cells */
    struct cell *cells;
    bool failed;
    struct column columns[MAX_COLUMNS];
    meta meta[MAX_META];
};

/* ---- filling ---- */

/* "name value" lines become one text. */
static void add_settings(struct table *t, const struct request *r) {
    char *text = request_describe(r);
    for (char *p = text; p != NULL && *p; p++) {
        const char *separator = p[1] ? ";" : "";
        if (*p == '\n') {
            *p = *separator;
        }
    }
    table_meta(t, "settings", "%s", text != NULL ? text : "");
    free(text);
}

struct table *table_new(const struct request *r) {
    struct table *t = calloc(1, sizeof *t);
    if (t != NULL) {
        table_meta(t, "experiment", "%s", r->experiment->name);
        table_meta(t, "command", "%s", r->command);
        table_meta(t, "version", "sheard %s", shear_version());
        add_settings(t, r);
    }
    return t;
}

void table_free(struct table *t) {
    if (t != NULL) {
        free(t->cells);
        free(t);
    }
}

void table_column(struct table *t, const char *name, int kind, int digits, const char *unit,
                  const char *help) {
    if (t == NULL || t->n_columns == MAX_COLUMNS) {
        return;
    }
    struct column *c = &t->columns[t->n_columns++];
    *c = (struct column){.kind = kind, .digits = digits, .width = (int)strlen(name)};
    snprintf(c->name, sizeof c->name, "%s", name);
    snprintf(c->unit, sizeof c->unit, "%s", unit);
    snprintf(c->help, sizeof c->help, "%s", help);
}

static struct cell *next_cell(struct table *t, struct column **column) {
    if (t == NULL || t->failed || t->n_columns == 0) {
        return NULL;
    }
    if (t->n == t->room) {
        size_t room = t->room > 0 ? 2 * t->room : 256;
        struct cell *larger = realloc(t->cells, room * sizeof *larger);
        if (larger == NULL) {
            t->failed = true;
            return NULL;
        }
        t->cells = larger;
        t->room = room;
    }
    *column = &t->columns[t->n % (size_t)t->n_columns];
    t->cells[t->n] = (struct cell){0};
    return &t->cells[t->n++];
}

/* The text of a number for people. */
static void format_cell(const struct column *c, double value, char *buf) {
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

static void widen(struct column *c, const char *text) {
    int width = (int)strlen(text);
    c->width = width > c->width ? width : c->width;
}

void table_number(struct table *t, double value) {
    struct column *column = NULL;
    struct cell *cell = next_cell(t, &column);
    if (cell != NULL) {
        cell->number = value;
        format_cell(column, value, cell->text);
        widen(column, cell->text);
    }
}

void table_text(struct table *t, const char *text) {
    struct column *column = NULL;
    struct cell *cell = next_cell(t, &column);
    if (cell != NULL) {
        snprintf(cell->text, sizeof cell->text, "%s", text);
        widen(column, cell->text);
    }
}

void table_meta(struct table *t, const char *key, const char *format, ...) {
    if (t == NULL || t->n_meta == MAX_META) {
        return;
    }
    meta *m = &t->meta[t->n_meta++];
    snprintf(m->key, sizeof m->key, "%s", key);
    va_list args;
    va_start(args, format);
    vsnprintf(m->text, sizeof m->text, format, args);
    va_end(args);
}

/* ---- for people ---- */

static void print_cell(FILE *out, const struct column *c, const char *text, bool last) {
    bool left = c->kind == TABLE_TEXT;
    fprintf(out, "%*s%s", left ? -c->width : c->width, text, last ? "\n" : "  ");
}

void table_print(const struct table *t, FILE *out) {
    if (t == NULL) {
        return;
    }
    for (int i = 0; i < t->n_columns; i++) {
        print_cell(out, &t->columns[i], t->columns[i].name, i + 1 == t->n_columns);
    }
    for (size_t k = 0; k < t->n; k++) {
        int i = (int)(k % (size_t)t->n_columns);
        print_cell(out, &t->columns[i], t->cells[k].text, i + 1 == t->n_columns);
    }
    for (int i = 0; i < t->n_meta; i++) {
        if (strcmp(t->meta[i].key, "verdict") == 0) {
            fprintf(out, "%s\n", t->meta[i].text);
        }
    }
}

/* ---- ECSV ---- */

/* A YAML scalar between single quotes. */
static void print_yaml(FILE *out, const char *text) {
    fputc('\'', out);
    for (; *text; text++) {
        fputs(*text == '\'' ? "''" : (char[]){*text, '\0'}, out);
    }
    fputc('\'', out);
}

static void print_head(const struct table *t, FILE *out) {
    static const char *const types[] = {"float64", "int64", "string"};
    fputs("# %ECSV 1.0\n# ---\n# datatype:\n", out);
    for (int i = 0; i < t->n_columns; i++) {
        const struct column *c = &t->columns[i];
        fprintf(out, "# - {name: %s, %s%s%sdatatype: %s, description: ", c->name,
                c->unit[0] ? "unit: " : "", c->unit, c->unit[0] ? ", " : "", types[c->kind]);
        print_yaml(out, c->help);
        fputs("}\n", out);
    }
    fputs("# meta: !!omap\n", out);
    for (int i = 0; i < t->n_meta; i++) {
        bool again = false; /* a key may be there several times: number them */
        int number = 1;
        for (int k = 0; k < i; k++) {
            again = strcmp(t->meta[k].key, t->meta[i].key) == 0;
            number += again;
        }
        fprintf(out, "# - %s", t->meta[i].key);
        if (number > 1) {
            fprintf(out, "%d", number);
        }
        fputs(": ", out);
        print_yaml(out, t->meta[i].text);
        fputc('\n', out);
    }
    fputs("# schema: astropy-2.0\n", out);
    for (int i = 0; i < t->n_columns; i++) {
        fprintf(out, "%s%s", t->columns[i].name, i + 1 < t->n_columns ? " " : "\n");
    }
}

static void print_body(const struct table *t, FILE *out) {
    for (size_t k = 0; k < t->n; k++) {
        int i = (int)(k % (size_t)t->n_columns);
        const struct cell *cell = &t->cells[k];
        if (t->columns[i].kind == TABLE_TEXT) {
            fprintf(out, "\"%s\"", cell->text);
        } else if (t->columns[i].kind == TABLE_INTEGER) {
            fprintf(out, "%.0f", cell->number);
        } else {
            fprintf(out, "%.10g", cell->number);
        }
        fputs(i + 1 < t->n_columns ? " " : "\n", out);
    }
}

static int cannot_write(const char *path, shear_error *err) {
    return shear_fail(err, SHEAR_E_IO, NULL, "cannot write '%s': %s", path, strerror(errno));
}

int table_save(const struct table *t, const struct request *r, shear_error *err) {
    char path[700];
    char part[720];
    if (t == NULL || t->failed) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a table");
    }
    request_path(r, NULL, "ecsv", path, sizeof path);
    snprintf(part, sizeof part, "%s.part", path);
    FILE *out = fopen(part, "w");
    if (out == NULL) {
        return cannot_write(part, err);
    }
    print_head(t, out);
    print_body(t, out);
    bool failed = ferror(out) != 0;
    failed = fclose(out) != 0 || failed;
    return !failed && rename(part, path) == 0 ? SHEAR_OK : cannot_write(path, err);
}

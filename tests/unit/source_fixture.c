/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "source_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const shear_exposure defaults = {.origin = 1};

const char *source_fixture_real(const char *name) {
    static char paths[4][600];
    static int next;
    char *path = paths[next];
    next = (next + 1) % 4;
    snprintf(path, sizeof paths[0], "%s/survey/%s", SHEAR_SHARED, name);
    return access(path, R_OK) == 0 ? path : NULL;
}

/* ---- writing ---- */

static void ok(int status) {
    if (status != 0) {
        fits_report_error(stderr, status);
        fail_msg("the test's own CFITSIO call failed with status %d", status);
    }
}

void source_fixture_table(fitsfile *f, const char *extname, const source_fixture_column *columns,
                          int n_columns, long n) {
    char *names[40];
    char *forms[40];
    char *units[40];
    int status = 0;
    assert_true(n_columns <= 40);
    for (int k = 0; k < n_columns; k++) {
        names[k] = (char *)(uintptr_t)columns[k].name;
        forms[k] = (char *)(uintptr_t)columns[k].form;
        units[k] = (char *)(uintptr_t)(columns[k].unit != NULL ? columns[k].unit : "");
    }
    fits_create_tbl(f, BINARY_TBL, 0, n_columns, names, forms, units, extname, &status);
    ok(status);
    source_fixture_fill(f, columns, n_columns, n);
}

void source_fixture_fill(fitsfile *f, const source_fixture_column *columns, int n_columns, long n) {
    int status = 0;
    for (int k = 0; k < n_columns; k++) {
        int type = 0;
        long repeat = 0;
        long width = 0;
        fits_get_coltype(f, k + 1, &type, &repeat, &width, &status);
        for (long i = 0; i < n && type != TSTRING; i++) {
            double v = columns[k].value(i);
            char logical = v != 0.0;
            for (long e = 0; e < repeat; e++) {
                fits_write_col(f, type == TLOGICAL ? TLOGICAL : TDOUBLE, k + 1, i + 1, e + 1, 1,
                               type == TLOGICAL ? (void *)&logical : (void *)&v, &status);
            }
        }
    }
    ok(status);
}

void source_fixture_header(fitsfile *f, const char *extname, const char *const *cards) {
    char text[80 * 40 + 1] = "";
    char form[24];
    char *names[] = {(char *)(uintptr_t) "Field Header Card"};
    char *forms[] = {form};
    char *start = text;
    int status = 0;
    int n = 0;
    for (; cards[n] != NULL; n++)
        snprintf(text + (size_t)n * 80, 81, "%-80s", cards[n]);
    snprintf(form, sizeof form, "%dA", n * 80);
    fits_create_tbl(f, BINARY_TBL, 0, 1, names, forms, NULL, extname, &status);
    fits_write_col(f, TSTRING, 1, 1, 1, 1, &start, &status);
    ok(status);
}

static double number(long i) {
    return (double)(i + 1);
}
static double x(long i) {
    return 10.5 + (double)i * 1.25;
}
static double y(long i) {
    return 2000.0 - (double)i * 0.5;
}
static double flags(long i) {
    return (double)(i % 8);
}
static double mag(long i) {
    return 18.0 + (double)(i % 10) * 0.5;
}

const source_fixture_column source_fixture_usual[5] = {{"NUMBER", "1J", NULL, number},
                                                       {"X_IMAGE", "1E", "pixel", x},
                                                       {"Y_IMAGE", "1E", "pixel", y},
                                                       {"FLAGS", "1I", NULL, flags},
                                                       {"MAG_AUTO", "1E", "mag", mag}};

void source_fixture_write(const char *path, long n) {
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "OBJECTS", source_fixture_usual, 5, n);
    fixture_close(f);
}

void source_fixture_text(const char *path, const char *text) {
    fixture_save(path, text, strlen(text));
}

/* ---- reading ---- */

source_catalog *source_fixture_open(const char *path, const shear_exposure *exposure) {
    source_catalog *c = NULL;
    shear_error err = {0};
    const shear_input_part part = {.path = path, .hdu = -1};
    if (source_catalog_open(&c, &part, -1, exposure != NULL ? exposure : &defaults, &err) != 0)
        fail_msg("%s: %s", path, err.message);
    return c;
}

source_list source_fixture_load(source_catalog *c, int i) {
    source_list s;
    shear_error err = {0};
    if (source_catalog_load(c, i, NULL, 0, NULL, &s, &err) != 0)
        fail_msg("%s", err.message);
    return s;
}

source_list source_fixture_read(const char *path, const shear_exposure *exposure) {
    source_catalog *c = source_fixture_open(path, exposure);
    assert_int_equal(source_catalog_tables(c), 1);
    source_list s = source_fixture_load(c, 0);
    source_catalog_close(c);
    return s;
}

int64_t source_fixture_selected(const source_list *s) {
    int64_t n = 0;
    for (int64_t i = 0; i < s->n; i++)
        n += s->selected[i];
    return n;
}

void source_fixture_expect(const char *path, const shear_exposure *exposure, int code, ...) {
    source_catalog *c = NULL;
    source_list s = {0};
    shear_error err = {0};
    const shear_input_part part = {.path = path, .hdu = -1};
    int got = source_catalog_open(&c, &part, -1, exposure != NULL ? exposure : &defaults, &err);
    if (got == SHEAR_OK)
        got = source_catalog_load(c, 0, NULL, 0, NULL, &s, &err);
    if (got != code)
        fail_msg("code %d, not %d: %s", got, code, err.message);
    source_list_deinit(&s);
    source_catalog_close(c);
    char all[sizeof err.message + sizeof err.advice];
    snprintf(all, sizeof all, "%s %s", err.message, err.advice);
    va_list words;
    va_start(words, code);
    for (const char *word; (word = va_arg(words, const char *)) != NULL;) {
        if (strstr(all, word) == NULL)
            fail_msg("no '%s' in: %s", word, all);
    }
    va_end(words);
}

/* ---- CFITSIO's leak ---- */

/* Up to version 4.2 CFITSIO keeps its copy of an expression that has a syntax error. The leak
 * sanitizer, if there is one, asks this function. */
const char *__lsan_default_suppressions(void) __attribute__((visibility("default")));
const char *__lsan_default_suppressions(void) {
    return "leak:ffiprs\n";
}

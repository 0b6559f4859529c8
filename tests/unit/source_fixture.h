/* SPDX-License-Identifier: GPL-3.0-or-later */
/* source_fixture.h: catalogs of sources, written by CFITSIO or as text, and read by the library. */
#pragma once

#include "fits_fixture.h"
#include "survey/sources/source_list.h"

/* Return the path of a real file of a survey, or NULL if there is none. */
const char *source_fixture_real(const char *name);

/* A column of a table to be written; value(i) of row i, in the table's own units. */
typedef struct source_fixture_column {
    const char *name, *form, *unit;
    double (*value)(long i);
} source_fixture_column;

/* Append a table of n rows; of a vector, all elements have the row's value. */
void source_fixture_table(fitsfile *f, const char *extname, const source_fixture_column *columns,
                          int n_columns, long n);
/* Write n rows into the table that was appended last. */
void source_fixture_fill(fitsfile *f, const source_fixture_column *columns, int n_columns, long n);
/* Append LDAC_IMHEAD with these cards, an array ended by NULL. */
void source_fixture_header(fitsfile *f, const char *extname, const char *const *cards);
/* Write a file with one table, OBJECTS, of NUMBER, X_IMAGE, Y_IMAGE, FLAGS, MAG_AUTO. */
void source_fixture_write(const char *path, long n);
extern const source_fixture_column source_fixture_usual[5];
/* Write a text. */
void source_fixture_text(const char *path, const char *text);

/* Open; all must go well. Options may be NULL. */
source_catalog *source_fixture_open(const char *path, const shear_exposure *exposure);
/* Load a table; all must go well. */
source_list source_fixture_load(source_catalog *c, int i);
/* Open and load the only table. */
source_list source_fixture_read(const char *path, const shear_exposure *exposure);
/* Return how many rows are selected. */
int64_t source_fixture_selected(const source_list *s);

/* Opening, or loading the first table, must fail with `code`; message and advice must contain each
 * of the words up to NULL. */
void source_fixture_expect(const char *path, const shear_exposure *exposure, int code, ...);

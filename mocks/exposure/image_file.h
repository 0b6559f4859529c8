/* SPDX-License-Identifier: GPL-3.0-or-later */
/* image_file.h: writes a FITS file of image extensions and tables, which gets its name when it is
 * complete. */
#pragma once

#include "base/buffer.h"
#include "shear/error.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* ---- the cards of a header, in a buffer ---- */
void image_card_int(buffer *cards, const char *key, int64_t value, const char *comment);
void image_card_real(buffer *cards, const char *key, double value, const char *comment);
void image_card_text(buffer *cards, const char *key, const char *value, const char *comment);
void image_card_logical(buffer *cards, const char *key, bool value, const char *comment);
void image_card_history(buffer *cards, const char *text);

/* ---- files ---- */
typedef struct image_file {
    FILE *stream; /* NULL: none */
    char *path, *temporary;
    bool overwrite;
} image_file;

/* Create the file with an empty primary HDU that has `cards`, under a temporary name. Call
 * image_file_abort after an error. */
int image_file_create(image_file *f, const char *path, bool overwrite, const buffer *cards,
                      shear_error *err);
/* Append an image extension: pixels[ny][nx] as BITPIX -32 or 16. */
int image_file_add_image(image_file *f, const char *name, int bitpix, int nx, int ny,
                         const double *pixels, const buffer *cards, shear_error *err);

/* A column of a table: 'D' (double) or 'J' (int32_t). */
typedef struct image_column {
    const char *name, *unit;
    char type;
} image_column;

/* Append the big-endian bytes of a value to the rows of a table. */
void image_row_double(buffer *rows, double value);
void image_row_int(buffer *rows, int32_t value);
/* Append a binary table with these rows. */
int image_file_add_table(image_file *f, const char *name, const image_column *columns, int n,
                         const buffer *rows, const buffer *cards, shear_error *err);

/* Complete the file and give it its name. */
int image_file_finish(image_file *f, shear_error *err);
/* Remove a file that is not finished; nothing happens to one that is, or to {0}. */
void image_file_abort(image_file *f);

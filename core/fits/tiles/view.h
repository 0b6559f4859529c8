/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/view.h: a view of one image or table for CFITSIO, with a header made for it.
 *
 * CFITSIO parses a file's headers by itself and acts on keywords whose values nobody has checked.
 * So it is never given the file. A view is a FITS file that exists only in CFITSIO's reads (through
 * an I/O driver of this library): a header of the keywords below, each checked and written here,
 * followed by the bytes of one HDU's data. Nothing else in the file's headers, of this HDU or
 * another, reaches CFITSIO. */
#pragma once

#include "base/buffer.h"
#include "fits/header/file.h"

#include <fitsio.h>

typedef struct sf_view {
    const sf_file *file;
    int64_t data_offset, data_bytes; /* in the file; zeros follow up to a whole block */
    buffer header;                   /* whole blocks once the view is open */
    int slot;                        /* of the driver, from 1; 0 = none */
} sf_view;

/* Begin a view of the data of `hdu`, and write its header card by card, except END. */
void sf_view_init(sf_view *v, const sf_file *file, const sf_hdu *hdu);
void sf_view_logical(sf_view *v, const char *key, bool value);
void sf_view_int(sf_view *v, const char *key, int64_t value);
void sf_view_double(sf_view *v, const char *key, double value);
void sf_view_string(sf_view *v, const char *key, const char *value); /* without quotes in it */
/* Write BSCALE and BZERO, unless they are 1 and 0. */
void sf_view_scale(sf_view *v, double scale, double zero);
/* Write an empty primary header, and begin that of a table with the rows of `hdu`, which `heap`
 * bytes follow; TTYPEn and TFORMn of its columns are next. */
void sf_view_table(sf_view *v, const sf_hdu *hdu, int64_t heap, int columns);
/* End a header. More headers may follow (only the last one has data). */
void sf_view_end(sf_view *v);

/* Open the view at its HDU `number` (from 0). Close *fits before sf_view_deinit, also after an
 * error. */
int sf_view_open(sf_view *v, int number, sf_place at, fitsfile **fits, shear_error *err);
void sf_view_close(fitsfile *fits);
void sf_view_deinit(sf_view *v);

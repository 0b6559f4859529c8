/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/view.h: what CFITSIO sees of a file: one image, under a header that was made for it.
 *
 * CFITSIO walks through a file's headers by itself and acts on keywords that nobody has bounded. So
 * it is never given the file. A view is a FITS file that exists only for CFITSIO's reads (an I/O
 * driver of ours): a header of the keywords below, each checked and written by us, and behind it
 * the bytes of one HDU's data. Whatever else stands in the file's headers, in this HDU or another,
 * does not reach CFITSIO.
 */
#ifndef SHEAR_FITS_TILES_VIEW_H
#define SHEAR_FITS_TILES_VIEW_H

#include "base/buffer.h"
#include "fits/header/file.h"

#include <fitsio.h>

typedef struct sf_view {
    const sf_file *file;
    int64_t data_offset, data_bytes; /* in the file; zeros behind them up to a whole block */
    buffer header;                   /* whole blocks once it is open */
    int slot;                        /* the driver's, from 1; 0 = none */
} sf_view;

/* Begin a view of the data of `hdu`, and write its header card by card, END excepted. */
void sf_view_init(sf_view *v, const sf_file *file, const sf_hdu *hdu);
void sf_view_logical(sf_view *v, const char *key, bool value);
void sf_view_int(sf_view *v, const char *key, int64_t value);
void sf_view_double(sf_view *v, const char *key, double value);
void sf_view_string(sf_view *v, const char *key, const char *value); /* without quotes in it */
/* The header is complete: END. More headers may follow (only the last has data). */
void sf_view_end(sf_view *v);

/* Open it at HDU `number` (from 0) of the view. *fits is NULL on error; close it before the view is
 * deinit'ed. */
int sf_view_open(sf_view *v, int number, sf_place at, fitsfile **fits, shear_error *err);
void sf_view_close(fitsfile *fits);
void sf_view_deinit(sf_view *v);

#endif

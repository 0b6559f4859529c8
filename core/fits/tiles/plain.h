/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/plain.h: the pixels of a plain image, without CFITSIO but with its values to the last
 * bit: a read of the file, and a loop that swaps bytes. */
#pragma once

#include "fits/header/cards.h"

typedef struct sf_plain {
    const sf_file *file;
    int64_t data_offset;
    int64_t axes[SF_AXES];
    int bitpix;
    double scale, zero; /* BSCALE, BZERO */
    bool has_blank;     /* BLANK, of integers only */
    int64_t blank;
    sf_place at;
} sf_plain;

/* Read out[size[2]][size[1]][size[0]], the box at `first` (0-based), which must lie in the image.
 * BLANK is NaN. SHEAR_E_IO, SHEAR_E_FORMAT: the data end early. */
int sf_plain_read(const sf_plain *p, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                  double *out, shear_error *err);

/* Return whether a float has the value of any pixel, whatever the pixels are. */
bool sf_plain_fits_float(const sf_plain *p);

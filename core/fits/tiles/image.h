/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/image.h: read an image HDU, plain or tile-compressed, in boxes of pixels as
 * doubles. */
#pragma once

#include "fits/tiles/plain.h"
#include "fits/tiles/tiles.h"

typedef struct sf_image {
    sf_cards cards;        /* of the image's HDU */
    int naxis;             /* 2 or 3 */
    int64_t axes[SF_AXES]; /* all positive; 1 beyond naxis */
    int bitpix;            /* as stored, before BSCALE */
    bool compressed;
    sf_plain plain; /* unless compressed */
    sf_table table; /* if compressed, like all that follow */
    sf_tiling tiling;
    sf_tiles tiles;
    sf_view view;
    fitsfile *fits; /* of the view */
} sf_image;

/* Open the image HDU that messages call `label`. *image must not move: its parts point to each
 * other. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. Call sf_image_deinit after an error, too. */
int sf_image_init(sf_image *image, const sf_file *file, const sf_hdu *hdu, const char *label,
                  shear_error *err);
void sf_image_deinit(sf_image *image);

/* Read out[size[2]][size[1]][size[0]], the box at `first` (0-based), which must lie in the image.
 * BLANK is NaN. NaN and infinities of plain images are kept; those of compressed images become
 * NaN. */
int sf_image_read(sf_image *image, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                  double *out, shear_error *err);
/* Read whole planes [first, first + count) into out[count][axes[1]][axes[0]]. */
int sf_image_planes(sf_image *image, int64_t first, int64_t count, double *out, shear_error *err);

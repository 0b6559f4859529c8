/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/stamps.h: an image HDU as a sequence of stamps, laid out as a cube or as a mosaic. */
#ifndef SHEAR_FITS_FIELD_STAMPS_H
#define SHEAR_FITS_FIELD_STAMPS_H

#include "fits/field/parts.h"
#include "fits/tiles/image.h"
#include "shear/field.h"

typedef struct sf_stamps {
    sf_image image;
    enum shear_layout layout;
    int nx, ny;      /* of a stamp */
    int64_t columns; /* stamps in a row of the mosaic */
    int64_t n;
    double *scratch; /* [capacity]: a run of stamps of one mosaic row */
    size_t capacity;
} sf_stamps;

/* Open the HDU of `part`, which outlives *s. Deinit it, also after an error. SHEAR_E_FORMAT. */
int sf_stamps_init(sf_stamps *s, const sf_part *part, shear_error *err);
void sf_stamps_deinit(sf_stamps *s);

/* out[count][ny][nx] = stamps [first, first + count). */
int sf_stamps_read(sf_stamps *s, int64_t first, int64_t count, double *out, shear_error *err);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/stamps.h: read an image HDU as a sequence of stamps, from a cube or a mosaic. */
#pragma once

#include "fits/field/parts.h"
#include "fits/tiles/image.h"
#include "shear/field.h"

typedef struct sf_stamps {
    sf_image image;
    enum shear_layout layout;
    int nx, ny;      /* of a stamp */
    int64_t columns; /* stamps per row of the mosaic */
    int64_t n;
    double *scratch; /* [capacity]: a run of stamps of one mosaic row */
    size_t capacity;
} sf_stamps;

/* Open the HDU of `part`, which must outlive *s; `mosaic` overrides its keywords. SHEAR_E_FORMAT.
 * Call sf_stamps_deinit after an error, too. */
int sf_stamps_init(sf_stamps *s, const sf_part *part, const shear_mosaic *mosaic, shear_error *err);
void sf_stamps_deinit(sf_stamps *s);

/* Read stamps [first, first + count) into out[count][ny][nx]. */
int sf_stamps_read(sf_stamps *s, int64_t first, int64_t count, double *out, shear_error *err);

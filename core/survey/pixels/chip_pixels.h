/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/chip_pixels.h: the pixels of a chip: values, standard deviations, defects, and the
 * object that each belongs to; read in boxes, through a cache of bands of rows.
 *
 * Memory is bounded by the cache (192 MiB; of it 48 for a catalog in the order of rows), not by the
 * image. Pixels count from 0 here. A chip_pixels is used by one thread at a time; those of one
 * exposure may be used by several. */
#pragma once

#include "survey/pixels/exposure_images.h"

#include <stdbool.h>

/* Why a pixel cannot be used. */
enum pixel_defect {
    PIXEL_BAD = 1,       /* weight 0, mask, NaN, infinity, BLANK, variance not positive */
    PIXEL_SATURATED = 2, /* at or above SATURATE, or in the mask's plane SAT */
    PIXEL_OUTSIDE = 4    /* beyond the chip */
};

/* An ellipse about an object, for images without a segmentation. */
typedef struct object_shape {
    double x, y;        /* centre, pixels from 0 */
    double a, b, theta; /* semi-axes, pixels; radians from x to y */
    int32_t owner;      /* what chip_pixels_read gives for its pixels, > 0 */
} object_shape;

typedef struct chip_pixels chip_pixels;
/* Open chip `i`. `e` must outlive *c. Without a segmentation, the owners of pixels are the `n`
 * shapes (borrowed; may be NULL): of several ellipses the one whose centre is nearest, in units of
 * its own radius. Shapes that are not finite, or have no positive axes, own nothing.
 * SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. *c is NULL on error. */
int chip_pixels_open(chip_pixels **c, const exposure_images *e, int i, const object_shape *shapes,
                     int64_t n, shear_error *err);
void chip_pixels_close(chip_pixels *c);
/* Return whether there is a segmentation image, so that owners are its values. */
bool chip_pixels_segmented(const chip_pixels *c);

/* A box of pixels [ny][nx]; any array may be NULL: it is not filled. */
typedef struct pixel_box {
    int x, y, nx, ny; /* its first pixel may be negative: PIXEL_OUTSIDE, with value and sigma NaN */
    double *value;
    float *sigma; /* standard deviation; NaN: unknown (no weight map, or a weight that is bad). Of a
                     map of weights it is 1/sqrt(weight): right up to a factor, the same everywhere,
                     because nothing in a file tells absolute weights from relative ones */
    uint8_t *defect; /* enum pixel_defect */
    int32_t *owner;  /* 0: sky; -1: segmentation value that is not a whole number up to 2^31 - 1 */
} pixel_box;
/* Fill the box. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. */
int chip_pixels_read(chip_pixels *c, const pixel_box *box, shear_error *err);

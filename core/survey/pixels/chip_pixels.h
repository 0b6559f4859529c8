/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/chip_pixels.h: the pixels of a chip: values, standard deviations, defects, and the
 * object that each belongs to; read in boxes, through a cache of bands of rows.
 *
 * Memory is bounded by the cache, not by the image. Pixels count from 0 here. A chip_pixels is used
 * by one thread at a time. */
#pragma once

#include "fits/header/file.h"
#include "shear/input.h"

#include <stdbool.h>
#include <stdint.h>

/* Why a pixel cannot be used. */
enum pixel_defect {
    PIXEL_BAD = 1,       /* weight 0, mask, NaN, BLANK, variance not positive */
    PIXEL_SATURATED = 2, /* at or above SATURATE, or in the mask's plane SAT */
    PIXEL_OUTSIDE = 4    /* beyond the chip */
};

/* The images of an exposure: an HDU per chip. */
typedef struct exposure_images exposure_images;

/* Open the image, and weight, mask and segmentation where given (fds as in shear_field_open_input).
 * If the image's HDU is chosen, that is the only chip; else every 2-D image HDU (of its file) that
 * is not a mask or a variance (EXTTYPE, EXTNAME) is one; the others are matched by EXTNAME, else by
 * order. SHEAR_E_IO; SHEAR_E_FORMAT: another shape or number of chips, an unknown plane, ... *e is
 * NULL on error. */
int exposure_images_open(exposure_images **e, const shear_input *input, const int *fds,
                         shear_error *err);
void exposure_images_close(exposure_images *e);
int exposure_images_chips(const exposure_images *e);
/* Return EXTNAME of chip `i`, or "". */
const char *exposure_images_name(const exposure_images *e, int i);
/* Return the header of chip `i`, [*count] cards of 80 characters; those of the primary HDU that the
 * extension does not have are appended. */
const char *exposure_images_header(const exposure_images *e, int i, int64_t *count);
/* Return width and height of chip `i`. */
void exposure_images_size(const exposure_images *e, int i, int *nx, int *ny);
/* Return the HDU of a part of chip `i`, from 0, or -1; and the bytes of all files on disk. */
int64_t exposure_images_hdu(const exposure_images *e, int i, enum shear_part part);
int64_t exposure_images_bytes(const exposure_images *e);

/* An ellipse about an object, for images without a segmentation. */
typedef struct object_shape {
    double x, y;        /* centre, pixels from 0 */
    double a, b, theta; /* semi-axes, pixels; radians from x to y */
    int32_t owner;      /* what chip_pixels_read gives for its pixels, > 0 */
} object_shape;

typedef struct chip_pixels chip_pixels;
/* Open chip `i`. Without a segmentation, the owners of pixels are the `n` shapes (borrowed; may be
 * NULL). */
int chip_pixels_open(chip_pixels **c, exposure_images *e, int i, const object_shape *shapes,
                     int64_t n, shear_error *err);
void chip_pixels_close(chip_pixels *c);
/* Return whether there is a segmentation image, so that owners are its values. */
bool chip_pixels_segmented(const chip_pixels *c);

/* A box of pixels [ny][nx]; any array may be NULL: it is not filled. */
typedef struct pixel_box {
    int x, y, nx, ny; /* its first pixel may be negative: PIXEL_OUTSIDE, with value and sigma NaN */
    double *value;
    float *sigma;    /* standard deviation; NaN: unknown (no weight map, or a relative one) */
    uint8_t *defect; /* enum pixel_defect */
    int32_t *owner;  /* 0: sky */
} pixel_box;
/* Fill the box. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. */
int chip_pixels_read(chip_pixels *c, const pixel_box *box, shear_error *err);

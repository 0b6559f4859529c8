/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/chip.h
 * Look at the chips of an open exposure (docs/exposures.md): what belongs to each, where its stamps
 * and their noise stamps lie, its pixels, and the shape of the PSF on it.
 *
 * Nothing here is needed to measure. Functions that read pixels hold one chip at a time, the same
 * as shear_field_read(): go through an exposure chip by chip. A field is used by one thread at a
 * time.
 */
#ifndef SHEAR_CHIP_H
#define SHEAR_CHIP_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/input.h"
#include "shear/linkage.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** A chip, and what was found for it. Texts are the field's. */
typedef struct shear_chip {
    const char *name;  /**< EXTNAME of its image; "" if it has none */
    int nx;            /**< columns, pixels */
    int ny;            /**< rows, pixels */
    int64_t first;     /**< number in the field of its first stamp */
    int64_t n_stamps;  /**< sources that are selected; their stamps have consecutive numbers */
    int64_t n_sources; /**< rows of its table of sources whose position is on the chip */
    /** Of a table that serves several chips: the distance of its nearest row from the chip's
     * middle, degrees; infinite if some of the chip has no place on the sky. Of others: NaN. */
    double nearest_source_deg;
    double corner_deg;    /**< in the same case: the distance of the farthest corner */
    int table;            /**< that table among those of the catalog, from 0 */
    bool has_wcs;         /**< there is a map from its pixels to the sky */
    int model;            /**< its PSF model, from 0 */
    const char *psf_chip; /**< EXTNAME that the model is for; "" if it does not say */
    const char *psf;      /**< a line that describes the model */
    int psf_terms;        /**< its coefficients */
    int psf_stars;        /**< stars that it was made from; -1: unknown */
    double r_psf_px;      /**< R_PSF in its middle, pixels; NaN: unknown */
    /** A quarter of the selected sources have a FLUX_RADIUS below it, pixels; NaN: unknown. */
    double source_quartile;
    double star_radius_px; /**< FLUX_RADIUS of the stars that are left out, pixels; NaN: unknown */
    double psf_radius_px;  /**< within it is half of the PSF's light, pixels; NaN: unknown */
    /** HDUs, from 0, of the images (enum shear_part: image, weight, mask, segmentation); -1: not
     * given. */
    int64_t hdu[SHEAR_N_PARTS];
} shear_chip;

/** Return the number of chips; 0: the field is not an exposure. */
int shear_field_chips(const shear_field *field);
/** Describe chip `i`, from 0. SHEAR_E_SETTING: there is no such chip. */
int shear_field_get_chip(const shear_field *field, int i, shear_chip *chip, shear_error *err);

/** The place of a stamp on its chip. */
typedef struct shear_chip_place {
    int chip;       /**< number of the chip */
    double x;       /**< position of the galaxy, pixels, the first is (1, 1) */
    double y;       /**< the same, row */
    uint32_t flags; /**< enum shear_flag, those that the reader finds */
    int box_x;      /**< first column of the stamp, from 0; -1: it has no place */
    int box_y;      /**< first row */
    int n_noise;    /**< noise stamps that are boxes of an image: all or none, unless flagged */
    int noise_x[SHEAR_MAX_NOISE_PLANES]; /**< [n_noise] their first columns */
    int noise_y[SHEAR_MAX_NOISE_PLANES]; /**< [n_noise] and rows */
} shear_chip_place;
/** Find the place of stamp `stamp` of the exposure, as shear_field_read() cuts it. SHEAR_E_SETTING:
 * there is no such stamp; SHEAR_E_NOMEM and errors of reading. */
int shear_chip_find(shear_field *field, int64_t stamp, shear_chip_place *place, shear_error *err);

/** Compute the second moments of the PSF at a stamp, those of the Gaussian that fits it best
 * (adaptive moments), without its pixels being drawn.
 *
 * @param field  an exposure
 * @param stamp  number of the stamp
 * @param cov    xx, xy, yy, square pixels, along the chip's columns and rows; NaN if the PSF has
 * none
 * @param err    what was wrong, or NULL
 * @return SHEAR_OK; SHEAR_E_SETTING: there is no such stamp; SHEAR_E_NOMEM
 */
int shear_chip_psf(const shear_field *field, int64_t stamp, double cov[3], shear_error *err);

/** Why a pixel cannot be used: bits. */
enum shear_defect {
    SHEAR_DEFECT_BAD = 1,       /**< by the weight map or the mask, or its value is no number */
    SHEAR_DEFECT_SATURATED = 2, /**< by its value, or the mask */
    SHEAR_DEFECT_OUTSIDE = 4    /**< beyond the chip */
};
/** A box of pixels, arrays of [ny][nx]. An array that is NULL is not filled. */
typedef struct shear_chip_box {
    int x;           /**< first column, from 0 */
    int y;           /**< first row */
    int nx;          /**< columns */
    int ny;          /**< rows */
    double *value;   /**< as in the image */
    uint8_t *defect; /**< enum shear_defect */
    int32_t *owner;  /**< number of the object that the pixel belongs to; 0: sky */
    float *sigma; /**< standard deviation by the weight map, up to a factor; NaN: there is none */
} shear_chip_box;
/** Read a box of a chip; faster row by row than column by column. SHEAR_E_SETTING: there is no such
 * chip; SHEAR_E_NOMEM and errors of reading. */
int shear_chip_read(shear_field *field, int chip, const shear_chip_box *box, shear_error *err);

/** Look at the first 64 sources of a chip that are on it: by the segmentation, how many have sky at
 * their position? *looked_at: their number; 0 without a segmentation. Errors as above. */
int shear_chip_unowned(shear_field *field, int chip, int64_t *looked_at, int64_t *unowned,
                       shear_error *err);

/** Compute how the weight map's standard deviations go with those of the sky, from place to place:
 * measured sigma is proportional to a power *slope of the map's, 1 for a right map. NaN: there is
 * no map, it is flat, or they do not go together. Errors as of shear_chip_read(). */
int shear_chip_weight_slope(shear_field *field, int chip, double *slope, shear_error *err);

SHEAR_END_C

#endif

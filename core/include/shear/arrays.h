/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/arrays.h
 * Measure the shear of stamps in memory, in one call.
 *
 * shear_measure_arrays() does for arrays what shear_run_file() does for a field file: it makes the
 * plan from the PSF and the settings, measures all stamps on all cores, and sums them. The result
 * is the same to the last bit as for a field file with the same numbers, for any number of threads
 * and any layout of the arrays.
 */
#ifndef SHEAR_ARRAYS_H
#define SHEAR_ARRAYS_H

#include "shear/error.h"
#include "shear/linkage.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/stamp.h"
#include "shear/sums.h"

#include <stddef.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** The type of a pixel in memory, in the machine's byte order and aligned for the type. */
enum shear_pixel_type {
    SHEAR_PIXEL_DOUBLE = 0, /**< double; used in place, without a copy, if there are no gaps */
    SHEAR_PIXEL_FLOAT,      /**< float */
    SHEAR_PIXEL_INT32,      /**< int32_t */
    SHEAR_PIXEL_INT16,      /**< int16_t */
    SHEAR_PIXEL_UINT16,     /**< uint16_t */
    SHEAR_PIXEL_UINT8       /**< uint8_t */
};

/**
 * Equal images in memory. The pixel in column x of row y of image i is at `pixels` + i `image` + y
 * `row` + x `column`, in bytes, as in NumPy; noise stamp k of galaxy i is another k `plane` bytes
 * further. Strides may be 0 or negative. If all four are 0, the images have no gaps and are in C
 * order: [images][rows][columns], noise [galaxies][planes][rows][columns].
 */
typedef struct shear_images {
    const void *pixels;         /**< the first pixel of image 0 */
    enum shear_pixel_type type; /**< of every pixel */
    ptrdiff_t image;            /**< bytes from one image (of a galaxy) to the next */
    ptrdiff_t plane;            /**< bytes from one noise stamp of a galaxy to the next */
    ptrdiff_t row;              /**< bytes from one row to the next */
    ptrdiff_t column;           /**< bytes from one pixel of a row to the next */
} shear_images;

/**
 * The stamps of one field. All arrays belong to the caller and are only read. A member that is zero
 * is not given; the comments say which must be.
 */
typedef struct shear_arrays {
    int64_t n_stamps;        /**< galaxies; at least 1 */
    shear_geometry geometry; /**< the sides of stamps and PSF images, and the PSF's sampling */
    int noise_planes;        /**< noise stamps per galaxy, at most SHEAR_MAX_NOISE_PLANES; 0 = 1 */
    int n_psf;               /**< PSF images; 0 = 1 */
    shear_images galaxy;     /**< [n_stamps][ny][nx]; must be given */
    shear_images noise;      /**< [n_stamps][noise_planes][ny][nx]; must be given */
    shear_images psf;        /**< [n_psf][psf_ny][psf_nx]; must be given */
    /** [n_stamps] the PSF image of each stamp, from 0; a stamp with any other number is flagged.
     * Ignored if n_psf is 1. May be NULL if n_psf is 1 or n_stamps. */
    const int32_t *psf_index;
    const double *weight; /**< [n_stamps] weights, or NULL: all 1 */
    const double *r_gal;  /**< [n_stamps] radius R_G for the filter, pixels, or NULL: unknown */
    const int32_t *mask;  /**< [n_stamps] not 0: the stamp is left out; or NULL: none is */
} shear_arrays;

/** Options and additional outputs. All zero, or NULL: only the result. */
typedef struct shear_arrays_options {
    int threads;           /**< 0: all cores */
    int jackknife;         /**< groups of the jackknife for the errors, at least 2; 0: none */
    shear_row *rows;       /**< [n_stamps] memory for every stamp's row, in stamp order, or NULL */
    shear_plan_info *plan; /**< memory for what the plan decided, or NULL */
    /** Sums to which this field's are added, or NULL. Use them to join fields that are measured one
     * by one; shear_field_result() then returns the shear of all. */
    shear_field_sums *sums;
    /** Called by one thread at a time with the number of stamps done; the run stops with
     * SHEAR_E_CANCELLED when it returns non-zero. May be NULL. */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context; /**< the first argument of `progress` */
} shear_arrays_options;

/**
 * Measure the shear of the stamps in `arrays`.
 *
 * Thread-safe. It needs the memory of the plan and, per thread, of a workspace and about a megabyte
 * for converted stamps if an array is not of doubles without gaps.
 *
 * @param result    the field's shear, with its errors and statistics; unchanged on error
 * @param arrays    the stamps
 * @param settings  the settings of the measurement, or NULL: the defaults
 * @param options   options and additional outputs, or NULL
 * @param err       what was wrong, or NULL
 * @return SHEAR_OK; SHEAR_E_FORMAT for impossible shapes and numbers; SHEAR_E_CANCELLED; errors
 *     of shear_plan_new(), shear_measure() and shear_jackknife_finish(). On error the sums are
 *     unchanged and the rows undefined.
 */
int shear_measure_arrays(shear_result *result, const shear_arrays *arrays,
                         const shear_settings *settings, const shear_arrays_options *options,
                         shear_error *err);

SHEAR_END_C

#endif

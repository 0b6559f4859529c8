/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/exposure_images.h: the HDUs of an exposure: image, weight map, mask and
 * segmentation of each chip.
 *
 * An exposure_images is not changed after it is opened, so that any number of threads may use it.
 */
#pragma once

#include "fits/header/file.h"
#include "shear/input.h"

#include <stdint.h>

typedef struct exposure_images exposure_images;

/* Open the image, and weight, mask and segmentation where given (fds as in shear_field_open_input).
 * If the image's HDU is chosen, that is the only chip; else every 2-D image HDU (of its file) that
 * is not a mask or a variance (EXTTYPE, EXTNAME) is one; the others are matched by EXTNAME, else by
 * order. A weight or mask that is not given is the HDU behind the image whose EXTTYPE is VARIANCE
 * or MASK, as LSST writes them: exposure_images_hdu() tells. SHEAR_E_IO; SHEAR_E_SETTING: mask_bad;
 * SHEAR_E_FORMAT: another shape or number of chips, an unknown plane, ... *e is NULL on error. */
int exposure_images_open(exposure_images **e, const shear_input *input, const int *fds,
                         shear_error *err);
void exposure_images_close(exposure_images *e);
int exposure_images_chips(const exposure_images *e);
/* Return EXTNAME of chip `i`, or "". */
const char *exposure_images_name(const exposure_images *e, int i);
/* Return the header of chip `i`, [*count] cards of 80 characters; those of the primary HDU that the
 * extension does not have are appended, unless INHERIT is F. A sky map is inherited as a whole or
 * not at all. */
const char *exposure_images_header(const exposure_images *e, int i, int64_t *count);
/* Return width and height of chip `i`. */
void exposure_images_size(const exposure_images *e, int i, int *nx, int *ny);
/* Return the HDU of a part of chip `i`, from 0, or -1; and the bytes of all files on disk. */
int64_t exposure_images_hdu(const exposure_images *e, int i, enum shear_part part);
int64_t exposure_images_bytes(const exposure_images *e);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exposure_fixture.h: exposures of a few images, and all pixels of a chip at once. */
#pragma once

#include "fits_fixture.h"
#include "survey/pixels/chip_pixels.h"

/* An input of parts by HDU number (-1: the default); a NULL path is not given. */
shear_input exposure_input(const char *image, const char *weight, const char *mask,
                           const char *segmentation);
/* Open, which must succeed. */
exposure_images *exposure_open(const shear_input *input);
/* Open must fail with `code`; message and advice must contain the words up to NULL. */
void exposure_expect(const shear_input *input, int code, ...);

/* Write a file with one image, in an extension called `name` (NULL: the primary HDU has it). */
void exposure_write(const char *path, const char *name, int bitpix, int nx, int ny,
                    const double *pixels);

/* All pixels of a chip, [ny][nx]. */
typedef struct chip_arrays {
    int nx, ny;
    double *value;
    float *sigma;
    uint8_t *defect;
    int32_t *owner;
} chip_arrays;
/* Open chip `i`, read all of it in one box, and close it. */
chip_arrays exposure_read(const exposure_images *e, int i, const object_shape *shapes, int64_t n);
void chip_arrays_free(chip_arrays *a);
/* The same of the only chip of an input. */
chip_arrays exposure_read_all(const shear_input *input);

/* "<shared>/survey/name", or NULL if there is no such file: the test is skipped. The last 8 answers
 * stay valid. */
const char *exposure_shared(const char *name);

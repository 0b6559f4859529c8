/* SPDX-License-Identifier: GPL-3.0-or-later */
/* psf_size.h: whether the PSF of a chip is as small as its sources are. */
#pragma once

#include "shear/chip.h"

#include <stddef.h>

/* A PSF that is broader than many sources was made from galaxies; one that is not as wide as
 * the stars is of another image. Write that, and return `line`;
 * NULL: nothing is wrong, or the sizes are unknown. */
const char *psf_size_warning(const shear_chip *chip, char *line, size_t size);
/* Return the median R_PSF of the chips' PSFs; NaN for fewer than four chips. */
double psf_size_median(const shear_field *field);
/* A PSF that differs much from those of the other chips is a failed fit. Write that, and return
 * `line`; NULL: it does not. */
const char *psf_size_odd(const shear_chip *chip, double median, char *line, size_t size);

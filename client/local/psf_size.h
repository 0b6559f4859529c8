/* SPDX-License-Identifier: GPL-3.0-or-later */
/* psf_size.h: whether the PSF of a chip is as small as its sources are. */
#pragma once

#include "local/warnings.h"
#include "shear/chip.h"

#include <stddef.h>

/* A PSF that is broader than many sources was made from galaxies. Write that, and return `line`;
 * NULL: nothing is wrong, or the sizes are unknown. */
const char *psf_size_warning(const shear_chip *chip, char *line, size_t size);
/* Add the warnings of all chips of an exposure, for `measure`. */
void psf_size_warn(const shear_field *field, warning_list *warnings);

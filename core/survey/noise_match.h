/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/noise_match.h: which image of noise belongs to which chip. */
#pragma once

#include "survey/internal.h"

/* Find the image of e->noise_images of a chip, which must be of the chip's size, and not its image.
 * `image` and `noise` are the files. Nothing is done where there are no images of noise.
 * SHEAR_E_FORMAT. */
int noise_match(const exposure *e, int chip, const char *image, const char *noise, int *found,
                shear_error *err);

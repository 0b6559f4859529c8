/* SPDX-License-Identifier: GPL-3.0-or-later */
/* segmentation.h: whether the segmentation knows the sources of the catalog. */
#pragma once

#include "shear/chip.h"

#include <stddef.h>

/* A segmentation of another chip, image or threshold leaves neighbours in the stamps. Write that,
 * with the numbers of shear_chip_unowned(), and return `line`; NULL: nothing is wrong. */
const char *segmentation_warning(int64_t looked_at, int64_t unowned, char *line, size_t size);

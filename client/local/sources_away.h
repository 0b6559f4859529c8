/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sources_away.h: whether a chip has no source of the catalog that serves all chips: then its
 * coordinates may be wrong, and its galaxies would be missing without a word. */
#pragma once

#include "shear/chip.h"

#include <stddef.h>

/* Write that no source is on the chip, and return `line`; NULL: there are some, or the catalog does
 * not serve all chips. */
const char *sources_away_warning(const shear_chip *chip, char *line, size_t size);
/* Return whether there are none near it either: it is no chip that is dead, or at the rim of the
 * catalog. */
bool sources_away_far(const shear_chip *chip);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/near_chip.h: which sources of a catalog of several chips may be on one of them. */
#pragma once

#include "survey/sources/source_cap.h"
#include "survey/wcs/sky_map.h"

/* Distances from a chip's middle, degrees. */
typedef struct near_chip {
    double nearest_deg; /* of the nearest source; INFINITY: some of the chip has no place on the
                           sky, or there is no source that has one */
    double corner_deg;  /* of its farthest corner; NaN: unknown */
} near_chip;

/* Return the cap of the sources that may be on the chip, so that only these are converted to its
 * pixels, and kept: of a large catalog that takes minutes for many chips. It reaches to 1.5 times
 * the distance of the chip's corners from its middle, and 2 arcmin; if some of the chip has no
 * place on the sky, it is the whole sky. */
source_cap near_chip_cap(sky_map *map, int nx, int ny, near_chip *found);
/* Find the distance of the nearest source, once the cap has seen all. */
void near_chip_measure(near_chip *found, const source_cap *cap);

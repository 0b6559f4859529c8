/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/near_chip.h: which sources of a catalog of several chips may be on one of them. */
#pragma once

#include "survey/sources/source_list.h"
#include "survey/wcs/sky_map.h"

/* Distances from a chip's middle, degrees. */
typedef struct near_chip {
    double nearest_deg; /* of the nearest source; INFINITY: some of the chip has no place on the
                           sky, or there is no source that has one */
    double corner_deg;  /* of its farthest corner; NaN: unknown */
} near_chip;

/* Drop the sources whose RA and Dec are far from the chip, so that only the others are converted to
 * its pixels, and kept: of a large catalog that takes minutes for many chips. Those within 1.5
 * times the distance of its corners from its middle, and 2 arcmin, remain. If some of the chip has
 * no place on the sky, all do. SHEAR_E_NOMEM. */
int near_chip_keep(source_list *sources, sky_map *map, int nx, int ny, near_chip *found,
                   shear_error *err);

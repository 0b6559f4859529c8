/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/chip_sky.h: the sky map of a chip, by its own header or by a .head file. */
#pragma once

#include "survey/internal.h"
#include "survey/wcs/head_file.h"

enum { CHIP_SKY_PLACE = 4200 };

/* Write which file and HDU has the chip's header, for messages. */
void chip_sky_place(const exposure *e, int chip, const char *image, char where[CHIP_SKY_PLACE]);

/* Make the map; NULL: the chip has no coordinates. `image` and `wcs` are the files; head->n is 0 if
 * there is no .head file. In the frame of pixels, coordinates that cannot be read are none.
 * SHEAR_E_FORMAT. */
int chip_sky_map(sky_map **map, const exposure *e, int chip, const char *image,
                 const head_file *head, const char *wcs, shear_error *err);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/empty_sky.h: the survey of a chip: where stamps of empty sky are, and its noise. */
#pragma once

#include "survey/cutout/box_map.h"
#include "survey/cutout/noise_mesh.h"
#include "survey/pixels/chip_pixels.h"

typedef struct empty_sky {
    box_map boxes;
    noise_mesh mesh;
    void *memory; /* of both; owned */
} empty_sky;

/* Read the chip once, in bands of rows. s->boxes has its sizes and those of stamps; all else is 0.
 * SHEAR_E_NOMEM and errors of reading; call empty_sky_deinit after an error, too. */
int empty_sky_init(empty_sky *s, chip_pixels *pixels, shear_error *err);
void empty_sky_deinit(empty_sky *s);

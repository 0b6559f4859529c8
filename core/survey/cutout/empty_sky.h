/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/empty_sky.h: the survey of a chip: where boxes of empty sky are, and its noise. */
#pragma once

#include "survey/cutout/box_map.h"
#include "survey/cutout/noise_mesh.h"
#include "survey/pixels/chip_pixels.h"

typedef struct empty_sky {
    box_map boxes;
    noise_mesh mesh;
    void *memory; /* of both; owned */
} empty_sky;

/* Read the chip of nx x ny pixels once, in bands of rows. `side` and `split_x` are those of
 * box_map. SHEAR_E_NOMEM and errors of reading; call empty_sky_deinit after an error, too. */
int empty_sky_init(empty_sky *s, chip_pixels *pixels, int nx, int ny, int split_x, int side,
                   shear_error *err);
void empty_sky_deinit(empty_sky *s);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/quiet_blocks.h: patches of sky that have been smoothed, interpolated or filled with
 * a constant, and have less noise than the sky around them, without a mask that says so.
 *
 * Whole blocks of 8 x 8 free pixels are looked at. A block is quiet if the mean squared difference
 * of its neighbouring pixels, along x or along y, is less than a tenth of the upper quartile of
 * those of 24 x 8 blocks around it, on its amplifier. No block of noise is so quiet by chance: the
 * quietest of 65,536 blocks of white noise has 0.25 (the probability for one block is about 1e-12),
 * so that nothing is chosen by its noise. Where the differences scatter too much for that (noise
 * that is smooth over more than 3 px, crowds of faint sources), where more than half of the pairs
 * of neighbours are equal (noise below 0.5 of a pixel's digit), or where most is quiet, none is. */
#pragma once

#include "survey/cutout/box_map.h"
#include "survey/cutout/noise_mesh.h"

typedef struct quiet_blocks {
    int columns; /* of whole blocks */
    double
        *step[2];   /* [8][columns] mean squared differences in x, and in y; NaN: not all is free */
    uint8_t *equal; /* [8][columns] number of pairs whose pixels are equal */
    double *sorted; /* scratch, like all below */
    double *sums[2];    /* [nx] squared differences along x and y, over the rows of a block */
    uint8_t *equals[2]; /* [nx] how many of them are 0 */
} quiet_blocks;

/* Place the memory for chips of nx columns. */
void quiet_blocks_place(quiet_blocks *q, int nx, arena *a);
/* Find the quiet blocks among rows of pixels of one amplifier (in y), at most MESH_SIDE, and mark
 * their cells. Where standard deviations are known, pixels are compared in units of them. */
void quiet_blocks_find(quiet_blocks *q, box_map *map, const mesh_pixels *p);

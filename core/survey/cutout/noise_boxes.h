/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/noise_boxes.h: which stamps of empty sky can serve a galaxy.
 *
 * They are all free ones on the grid (box_map.h) whose centre is within 200 px of the galaxy's (2.5
 * stamps with their frames, if that is more), on the amplifier of its position, whose frame does
 * not overlap its stamp, and whose noise is 0.8 to 1.25 times that at the galaxy. They come in an
 * order that only chip and source decide: each is equally likely to be the next one, whatever its
 * pixels.
 *
 * Of a galaxy that lies across the border of two amplifiers, at least half a stamp is on that of
 * its position. The other part has noise of the other one. For galaxies on both sides of a border
 * these errors are opposite, as power spectra of noise add up: their mean is zero to first order.
 */
#pragma once

#include "survey/cutout/draw.h"
#include "survey/cutout/empty_sky.h"

typedef struct noise_boxes {
    const empty_sky *sky;
    int32_t *list;        /* [n] their cells; those before `next` are drawn */
    uint8_t *gate;        /* [columns of meshes] scratch */
    int32_t *mesh_column; /* [columns of cells] of a stamp's centre */
    uint32_t n, next;
    draw_key key;
} noise_boxes;

/* Place the memory for the most boxes that there can be. */
void noise_boxes_place(noise_boxes *b, const empty_sky *sky, arena *a);
/* Find the stamps for a galaxy whose stamp begins at (x, y); the pixel of its position is the
 * stamp's middle, [stamp / 2][stamp / 2], and on the chip. */
void noise_boxes_find(noise_boxes *b, int x, int y, draw_key key);
/* Draw the next stamp, its first pixel; false: no more. */
bool noise_boxes_draw(noise_boxes *b, int *x, int *y);

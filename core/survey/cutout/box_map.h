/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/box_map.h: where on a chip a stamp of empty sky can be cut, on a grid of 4 px.
 *
 * A cell of 4 x 4 px is touched if a grown object has a pixel of it, or if it is within 8 px of a
 * quiet one. A place is free if the stamp
 * that begins there touches no such cell, and has at most 2 % of defects (all those of its cells,
 * if its side is no multiple of 4), and if it lies with its frame inside the chip, on one
 * amplifier. The frame may hold objects: it is masked like a galaxy's. */
#pragma once

#include "base/arena.h"
#include "survey/cutout/amplifier_axis.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BOX_CELL = 4, BOX_QUIET = 0x40, BOX_TOUCHED = 0x80 };

typedef struct box_map {
    amplifier_axis x, y; /* of the chip */
    int stamp;           /* side, pixels */
    int frame;           /* around it, pixels */
    int columns, rows;
    uint8_t *cells;  /* [rows][columns]: BOX_TOUCHED, BOX_QUIET, and the number of defects until
                        box_map_close(), then whether the place is free */
    int *sums;       /* [2][columns] scratch */
    uint8_t *fits;   /* [columns] whether the frame of a stamp there is on one amplifier in x */
    uint8_t *closed; /* [columns] scratch */
} box_map;

/* Place the arrays, for the sizes that are set; call it with memory after a call without. */
void box_map_place(box_map *m, arena *a);
/* Enter row `row` of cells, of [4 columns] numbers per column of pixels: whether a grown object
 * touches it, and how many of its 4 pixels are defects. */
void box_map_enter(box_map *m, int row, const uint8_t *grown, const uint8_t *defects);
/* Mark n x n cells, the first of which is given, as quiet: they have less noise than the sky. */
void box_map_silence(box_map *m, int row, int column, int n);
/* Find what is free, once all rows are entered. */
void box_map_close(box_map *m);

/* Return whether a grown object touches the cell of this pixel, or it is quiet. */
static inline bool box_map_touched(const box_map *m, int x, int y) {
    return m->cells[(size_t)(y / BOX_CELL) * (size_t)m->columns + (size_t)(x / BOX_CELL)] >=
           BOX_QUIET;
}
/* Return the row of cells, [columns]; bit 0: the stamp whose first pixel is the cell's is free. */
static inline const uint8_t *box_map_row(const box_map *m, int row) {
    return m->cells + (size_t)row * (size_t)m->columns;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/box_map.h: where on a chip an empty box fits, on a grid of 4 px.
 *
 * First a cell of 4 x 4 px is marked if a grown object touches it, with the number of its defects.
 * box_map_close() makes of this, in the same memory, whether the box that begins in a cell is
 * free: inside the chip, on one amplifier, without a marked cell, and with at most 2 % of defects
 * (those of the cells that it touches, if its side is no multiple of 4). */
#pragma once

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BOX_CELL = 4 };

typedef struct box_map {
    int nx, ny;  /* of the chip, pixels */
    int split_x; /* first column of the second amplifier; 0: one amplifier */
    int side;    /* of a box */
    int columns, rows;
    uint8_t *cells;  /* [rows][columns] */
    int *sums;       /* [2][columns] scratch */
    uint8_t *closed; /* [columns] scratch */
} box_map;

/* Set the sizes and place the arrays; the same call with memory after one without. */
void box_map_place(box_map *m, int nx, int ny, int split_x, int side, arena *a);
/* Enter row `row` of cells, of [4 columns] numbers per column of pixels: whether a grown object
 * touches it, and how many of its 4 pixels are defects. */
void box_map_enter(box_map *m, int row, const uint8_t *grown, const uint8_t *defects);
/* Return whether a grown object touches the cell of this pixel; before box_map_close(). */
static inline bool box_map_touched(const box_map *m, int x, int y) {
    return m->cells[(size_t)(y / BOX_CELL) * (size_t)m->columns + (size_t)(x / BOX_CELL)] >= 0x80;
}
void box_map_close(box_map *m);
/* Return the row of marks, [columns] 1: the box whose first pixel is that of the cell is free. */
static inline const uint8_t *box_map_row(const box_map *m, int row) {
    return m->cells + (size_t)row * (size_t)m->columns;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/box_map.h"

#include "base/simd.h"

#include <stddef.h>
#include <string.h>

enum { TOUCHED = 0x80, MOST_DEFECTS_PERCENT = 2 };

static int cells_of(int pixels) {
    return (pixels + BOX_CELL - 1) / BOX_CELL;
}

void box_map_place(box_map *m, int nx, int ny, int split_x, int side, arena *a) {
    m->nx = nx;
    m->ny = ny;
    m->split_x = split_x;
    m->side = side;
    m->columns = cells_of(nx);
    m->rows = cells_of(ny);
    m->cells = arena_take(a, (size_t)m->columns * (size_t)m->rows);
    m->sums = arena_take(a, 2 * (size_t)m->columns * sizeof *m->sums);
    m->closed = arena_take(a, (size_t)m->columns);
}

SHEAR_SIMD void box_map_enter(box_map *m, int row, const uint8_t *grown, const uint8_t *defects) {
    uint8_t *cells = m->cells + (size_t)row * (size_t)m->columns;
    for (int i = 0; i < m->columns; i++) {
        const uint8_t *g = grown + (ptrdiff_t)i * BOX_CELL;
        const uint8_t *d = defects + (ptrdiff_t)i * BOX_CELL;
        const int touched = (g[0] | g[1] | g[2] | g[3]) != 0 ? TOUCHED : 0;
        cells[i] = (uint8_t)(touched + d[0] + d[1] + d[2] + d[3]);
    }
}

/* Add (sign 1) or take off (-1) a row of cells from the sums over rows. */
static void sum_row(box_map *m, const uint8_t *cells, int sign) {
    int *touched = m->sums;
    int *defects = m->sums + m->columns;
    for (int i = 0; i < m->columns; i++) {
        touched[i] += sign * (cells[i] / TOUCHED);
        defects[i] += sign * (cells[i] % TOUCHED);
    }
}

/* Return whether a box may begin at pixel x. */
static bool fits(const box_map *m, int x) {
    return x + m->side <= m->nx && (x >= m->split_x || x + m->side <= m->split_x);
}

/* Write whether the boxes that begin in the row of cells are free, from the sums over their rows.
 */
static void close_row(const box_map *m, uint8_t *closed) {
    const int *touched = m->sums;
    const int *defects = m->sums + m->columns;
    const int box = cells_of(m->side);
    const int most = m->side * m->side * MOST_DEFECTS_PERCENT / 100;
    int t = 0;
    int d = 0;
    for (int i = 0; i < m->columns; i++) {
        for (int k = i == 0 ? 0 : i + box - 1; k < i + box && k < m->columns; k++) {
            t += touched[k];
            d += defects[k];
        }
        closed[i] = fits(m, i * BOX_CELL) && t == 0 && d <= most;
        t -= touched[i];
        d -= defects[i];
    }
}

void box_map_close(box_map *m) {
    const int box = cells_of(m->side);
    int added = 0;
    for (int j = 0; j < m->rows; j++) {
        uint8_t *cells = m->cells + (size_t)j * (size_t)m->columns;
        for (; added < j + box && added < m->rows; added++)
            sum_row(m, m->cells + (size_t)added * (size_t)m->columns, 1);
        memset(m->closed, 0, (size_t)m->columns);
        if (j * BOX_CELL + m->side <= m->ny)
            close_row(m, m->closed);
        sum_row(m, cells, -1);
        memcpy(cells, m->closed, (size_t)m->columns);
    }
}

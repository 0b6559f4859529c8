/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/box_map.h"

#include "base/simd.h"

#include <stddef.h>
#include <string.h>

enum { MOST_DEFECTS_PERCENT = 2, QUIET_GROW = 2 };

static int cells_of(int pixels) {
    return (pixels + BOX_CELL - 1) / BOX_CELL;
}

void box_map_place(box_map *m, arena *a) {
    m->columns = cells_of(m->x.pixels);
    m->rows = cells_of(m->y.pixels);
    m->cells = arena_take(a, (size_t)m->columns * (size_t)m->rows);
    m->sums = arena_take(a, 2 * (size_t)m->columns * sizeof *m->sums);
    m->fits = arena_take(a, (size_t)m->columns);
    m->closed = arena_take(a, (size_t)m->columns);
}

SHEAR_SIMD void box_map_enter(box_map *m, int row, const uint8_t *grown, const uint8_t *defects) {
    uint8_t *cells = m->cells + (size_t)row * (size_t)m->columns;
    for (int i = 0; i < m->columns; i++) {
        const uint8_t *g = grown + (ptrdiff_t)i * BOX_CELL;
        const uint8_t *d = defects + (ptrdiff_t)i * BOX_CELL;
        const int touched = (g[0] | g[1] | g[2] | g[3]) != 0 ? BOX_TOUCHED : 0;
        cells[i] = (uint8_t)(touched + d[0] + d[1] + d[2] + d[3]);
    }
}

/* Add (sign 1) or take off (-1) a row of cells from the sums over rows. */
static void sum_row(box_map *m, const uint8_t *cells, int sign) {
    int *touched = m->sums;
    int *defects = m->sums + m->columns;
    for (int i = 0; i < m->columns; i++) {
        touched[i] += sign * (cells[i] / BOX_TOUCHED);
        defects[i] += sign * (cells[i] % BOX_TOUCHED);
    }
}

/* Return whether the frame of a stamp that begins at pixel `at` of an axis is on one amplifier. */
static bool fits(const box_map *m, const amplifier_axis *axis, int at) {
    return amplifier_axis_holds(axis, at - m->frame, at + m->stamp + m->frame);
}

/* Write whether the boxes that begin in the row of cells are free, from the sums over their rows.
 */
static void close_row(const box_map *m, uint8_t *closed) {
    const int *touched = m->sums;
    const int *defects = m->sums + m->columns;
    const int box = cells_of(m->stamp);
    const int most = m->stamp * m->stamp * MOST_DEFECTS_PERCENT / 100;
    int t = 0;
    int d = 0;
    for (int i = 0; i < m->columns; i++) {
        for (int k = i == 0 ? 0 : i + box - 1; k < i + box && k < m->columns; k++) {
            t += touched[k];
            d += defects[k];
        }
        closed[i] = m->fits[i] != 0 && t == 0 && d <= most;
        t -= touched[i];
        d -= defects[i];
    }
}

void box_map_silence(box_map *m, int row, int column, int n) {
    for (int i = 0; i < n * n; i++) {
        m->cells[(size_t)(row + i / n) * (size_t)m->columns + (size_t)(column + i % n)] |=
            BOX_QUIET;
    }
}

/* Touch the cells around a quiet one: a patch ends somewhere in the next block. */
static void touch_around(box_map *m, int row, int column) {
    for (int j = row - QUIET_GROW; j <= row + QUIET_GROW; j++) {
        for (int i = column - QUIET_GROW; i <= column + QUIET_GROW; i++) {
            if (j >= 0 && j < m->rows && i >= 0 && i < m->columns)
                m->cells[(size_t)j * (size_t)m->columns + (size_t)i] |= BOX_TOUCHED;
        }
    }
}

static void touch_quiet(box_map *m) {
    for (int j = 0; j < m->rows; j++) {
        uint8_t *cells = m->cells + (size_t)j * (size_t)m->columns;
        for (int i = 0; i < m->columns; i++) {
            if ((cells[i] & BOX_QUIET) == 0)
                continue;
            cells[i] = (uint8_t)(cells[i] - BOX_QUIET);
            touch_around(m, j, i);
        }
    }
}

void box_map_close(box_map *m) {
    touch_quiet(m);
    const int box = cells_of(m->stamp);
    int added = 0;
    for (int i = 0; i < m->columns; i++)
        m->fits[i] = fits(m, &m->x, i * BOX_CELL);
    for (int j = 0; j < m->rows; j++) {
        uint8_t *cells = m->cells + (size_t)j * (size_t)m->columns;
        for (; added < j + box && added < m->rows; added++)
            sum_row(m, m->cells + (size_t)added * (size_t)m->columns, 1);
        memset(m->closed, 0, (size_t)m->columns);
        if (fits(m, &m->y, j * BOX_CELL))
            close_row(m, m->closed);
        sum_row(m, cells, -1);
        for (int i = 0; i < m->columns; i++)
            cells[i] = (cells[i] & BOX_TOUCHED) | m->closed[i];
    }
}

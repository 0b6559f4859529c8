/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/quiet_blocks.h"

#include "base/sort.h"

#include <math.h>

enum {
    SIDE = 8,                      /* pixels of a block */
    CELLS = SIDE / BOX_CELL,       /* cells along it */
    PAIRS = SIDE * (SIDE - 1),     /* of neighbours, in one direction */
    HIGH = MESH_SIDE / SIDE,       /* most rows of blocks */
    SEGMENT = 8,                   /* blocks that are compared with the same others ... */
    AROUND = 8,                    /* ... which are as many on both sides, too */
    WINDOW = SEGMENT + 2 * AROUND, /* columns of them */
    LEAST = 48                     /* blocks for a quartile */
};
static const double quiet = 0.1;
static const double widest = 1.4; /* ratio of the 95th percentile to the upper quartile; of white
                                     noise it is 1.22 */

void quiet_blocks_place(quiet_blocks *q, int nx, arena *a) {
    q->columns = nx / SIDE;
    const size_t n = HIGH * (size_t)q->columns;
    q->step[0] = arena_doubles(a, n);
    q->step[1] = arena_doubles(a, n);
    q->equal = arena_take(a, n);
    q->sorted = arena_doubles(a, HIGH * WINDOW);
}

/* Return whether a block, of which the first cell is given, has neither objects nor defects. */
static bool is_free(const box_map *map, int row, int column) {
    for (int i = 0; i < CELLS * CELLS; i++) {
        if (box_map_row(map, row + i / CELLS)[column + i % CELLS] != 0)
            return false;
    }
    return true;
}

/* Return the sum of the squared differences of pixels that are `apart`, and count equal ones. */
static double sum_steps(const double *v, int nx, int width, int height, int apart, int *equal) {
    double sum = 0.0;
    for (int y = 0; y < height; y++) {
        const double *row = v + (size_t)y * (size_t)nx;
        for (int x = 0; x < width; x++) {
            const double d = row[x + apart] - row[x];
            sum += d * d;
            *equal += d == 0.0;
        }
    }
    return sum;
}

/* Measure block `column` of the row of blocks `k`, whose first row of pixels is `row` of p. */
static void measure(quiet_blocks *q, const box_map *map, const mesh_pixels *p, int k, int row,
                    int column) {
    const int nx = map->x.pixels;
    const size_t at = (size_t)k * (size_t)q->columns + (size_t)column;
    const size_t first = (size_t)row * (size_t)nx + (size_t)column * SIDE;
    int equal = 0;
    q->step[0][at] = q->step[1][at] = NAN;
    if (!is_free(map, (p->y + row) / BOX_CELL, column * CELLS))
        return;
    const double sigma = (double)p->sigma[first];
    const double unit = isfinite(sigma) && sigma > 0.0 ? sigma * sigma : 1.0;
    const double *v = p->value + first;
    q->step[0][at] = sum_steps(v, nx, SIDE - 1, SIDE, 1, &equal) / (PAIRS * unit);
    q->step[1][at] = sum_steps(v, nx, SIDE, SIDE - 1, nx, &equal) / (PAIRS * unit);
    q->equal[at] = (uint8_t)equal;
}

/* Return the upper quartile of the blocks in columns first .. end-1 of `rows` rows; NaN: they do
 * not tell what noise is. */
static double quartile(const quiet_blocks *q, int direction, int rows, int first, int end) {
    size_t n = 0;
    size_t equal = 0;
    for (int k = 0; k < rows; k++) {
        for (int i = first; i < end; i++) {
            const size_t at = (size_t)k * (size_t)q->columns + (size_t)i;
            if (isfinite(q->step[direction][at])) {
                q->sorted[n++] = q->step[direction][at];
                equal += q->equal[at];
            }
        }
    }
    if (n < LEAST || equal > n * PAIRS)
        return NAN;
    sort_doubles(q->sorted, n);
    const double upper = q->sorted[n * 3 / 4];
    return q->sorted[n * 19 / 20] <= widest * upper ? upper : NAN;
}

/* Mark the quiet ones of a segment, in one direction. */
static void mark(const quiet_blocks *q, box_map *map, int direction, int rows, int row,
                 const int segment[2], double limit) {
    for (int k = 0; k < rows; k++) {
        for (int i = segment[0]; i < segment[1]; i++) {
            if (q->step[direction][(size_t)k * (size_t)q->columns + (size_t)i] < limit)
                box_map_silence(map, row + k * CELLS, i * CELLS, CELLS);
        }
    }
}

/* Look at the blocks in columns first .. end-1, which are of one amplifier. */
static void find(const quiet_blocks *q, box_map *map, int rows, int row, int first, int end) {
    for (int i = first; i < end; i += SEGMENT) {
        const int segment[2] = {i, i + SEGMENT < end ? i + SEGMENT : end};
        const int from = i - AROUND > first ? i - AROUND : first;
        const int to = i + SEGMENT + AROUND < end ? i + SEGMENT + AROUND : end;
        for (int d = 0; d < 2; d++)
            mark(q, map, d, rows, row, segment, quiet * quartile(q, d, rows, from, to));
    }
}

void quiet_blocks_find(quiet_blocks *q, box_map *map, const mesh_pixels *p) {
    const int skipped = (SIDE - p->y % SIDE) % SIDE; /* rows before the first whole block */
    const int rows = p->n > skipped ? (p->n - skipped) / SIDE : 0;
    for (int k = 0; k < rows; k++) {
        for (int i = 0; i < q->columns; i++)
            measure(q, map, p, k, skipped + k * SIDE, i);
    }
    for (int i = 0; i < map->x.parts; i++) {
        const int start = amplifier_axis_start(&map->x, i);
        find(q, map, rows, (p->y + skipped) / BOX_CELL, (start + SIDE - 1) / SIDE,
             amplifier_axis_start(&map->x, i + 1) / SIDE);
    }
}

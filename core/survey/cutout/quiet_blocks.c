/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/quiet_blocks.h"

#include "base/simd.h"
#include "base/sort.h"

#include <math.h>
#include <string.h>

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
    for (int d = 0; d < 2; d++) {
        q->sums[d] = arena_doubles(a, (size_t)nx);
        q->equals[d] = arena_take(a, (size_t)nx);
    }
}

/* Return whether a block, of which the first cell is given, has neither objects nor defects. */
static bool is_free(const box_map *map, int row, int column) {
    for (int i = 0; i < CELLS * CELLS; i++) {
        if (box_map_row(map, row + i / CELLS)[column + i % CELLS] != 0)
            return false;
    }
    return true;
}

/* Add the squared differences of pixels to sums[n], and whether they are equal to equal[n]. */
SHEAR_SIMD static void add_steps(double *restrict sums, uint8_t *restrict equal,
                                 const double *restrict from, const double *restrict to, size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double d = to[i] - from[i];
        sums[i] += d * d;
        equal[i] = (uint8_t)(equal[i] + (d == 0.0));
    }
}

/* Sum the steps of each pixel column within a row of blocks, whose first pixel is v. */
static void sum_columns(quiet_blocks *q, const double *v, size_t nx) {
    memset(q->sums[0], 0, nx * sizeof *q->sums[0]);
    memset(q->sums[1], 0, nx * sizeof *q->sums[1]);
    memset(q->equals[0], 0, nx);
    memset(q->equals[1], 0, nx);
    for (int y = 0; y < SIDE; y++, v += nx) {
        add_steps(q->sums[0], q->equals[0], v, v + 1, nx - 1);
        if (y < SIDE - 1)
            add_steps(q->sums[1], q->equals[1], v, v + nx, nx);
    }
}

/* Measure the row of blocks `k`, whose first row of pixels is `row` of p. */
static void measure(quiet_blocks *q, const box_map *map, const mesh_pixels *p, int k, int row) {
    const size_t nx = (size_t)map->x.pixels;
    const size_t first = (size_t)row * nx;
    sum_columns(q, p->value + first, nx);
    for (int column = 0; column < q->columns; column++) {
        const size_t at = (size_t)k * (size_t)q->columns + (size_t)column;
        const size_t x = (size_t)column * SIDE;
        const double sigma = (double)p->sigma[first + x];
        const double unit = isfinite(sigma) && sigma > 0.0 ? sigma * sigma : 1.0;
        double sums[2] = {0.0, 0.0};
        int equal = 0;
        q->step[0][at] = q->step[1][at] = NAN;
        if (!is_free(map, (p->y + row) / BOX_CELL, column * CELLS))
            continue;
        for (size_t i = 0; i < SIDE; i++) {
            sums[0] += i < SIDE - 1 ? q->sums[0][x + i] : 0.0;
            sums[1] += q->sums[1][x + i];
            equal += (i < SIDE - 1 ? q->equals[0][x + i] : 0) + q->equals[1][x + i];
        }
        q->step[0][at] = sums[0] / (PAIRS * unit);
        q->step[1][at] = sums[1] / (PAIRS * unit);
        q->equal[at] = (uint8_t)equal;
    }
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

/* Return whether one of a segment's blocks may be quiet among those in columns first .. end-1: a
 * quartile is at most the largest. Mostly none is, and nothing needs to be sorted. */
static bool may_be_quiet(const quiet_blocks *q, int direction, int rows, const int segment[2],
                         int first, int end) {
    double least = INFINITY;
    double most = 0.0;
    for (int k = 0; k < rows; k++) {
        const double *step = q->step[direction] + (size_t)k * (size_t)q->columns;
        for (int i = first; i < end; i++) {
            most = step[i] > most ? step[i] : most;
            if (i >= segment[0] && i < segment[1])
                least = step[i] < least ? step[i] : least;
        }
    }
    return least < quiet * most;
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
        for (int d = 0; d < 2; d++) {
            if (may_be_quiet(q, d, rows, segment, from, to))
                mark(q, map, d, rows, row, segment, quiet * quartile(q, d, rows, from, to));
        }
    }
}

void quiet_blocks_find(quiet_blocks *q, box_map *map, const mesh_pixels *p) {
    const int skipped = (SIDE - p->y % SIDE) % SIDE; /* rows before the first whole block */
    const int rows = p->n > skipped ? (p->n - skipped) / SIDE : 0;
    for (int k = 0; k < rows; k++)
        measure(q, map, p, k, skipped + k * SIDE);
    for (int i = 0; i < map->x.parts; i++) {
        const int start = amplifier_axis_start(&map->x, i);
        find(q, map, rows, (p->y + skipped) / BOX_CELL, (start + SIDE - 1) / SIDE,
             amplifier_axis_start(&map->x, i + 1) / SIDE);
    }
}

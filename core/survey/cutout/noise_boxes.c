/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/noise_boxes.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { REACH = 200, REACH_BOXES_HALVES = 5 };
static const double least_ratio = 0.8;
static const double most_ratio = 1.25;

/* Columns or rows of cells. */
typedef struct cell_range {
    int first, end;
} cell_range;

static int reach_of(const box_map *m) {
    const int64_t wide = (int64_t)(m->stamp + 2 * m->frame) * REACH_BOXES_HALVES / 2;
    return wide > REACH ? (int)wide : REACH;
}

void noise_boxes_place(noise_boxes *b, const empty_sky *sky, arena *a) {
    const box_map *m = &sky->boxes;
    const size_t across = 2 * (size_t)reach_of(m) / BOX_CELL + 1;
    const size_t columns = across < (size_t)m->columns ? across : (size_t)m->columns;
    const size_t rows = across < (size_t)m->rows ? across : (size_t)m->rows;
    b->sky = sky;
    b->list = arena_take(a, columns * rows * sizeof *b->list);
    b->gate = arena_take(a, (size_t)sky->mesh.columns);
    b->mesh_column = arena_take(a, (size_t)m->columns * sizeof *b->mesh_column);
    if (b->mesh_column == NULL)
        return;
    for (int i = 0; i < m->columns; i++) {
        const int x = i * BOX_CELL + m->stamp / 2;
        b->mesh_column[i] = noise_mesh_column(&sky->mesh, x < m->x.pixels ? x : m->x.pixels - 1);
    }
}

/* Open the meshes of a row whose noise is like the galaxy's. */
static void set_gate(noise_boxes *b, int row, double level) {
    const noise_mesh *mesh = &b->sky->mesh;
    const double *levels = mesh->level + (size_t)row * (size_t)mesh->columns;
    for (int i = 0; i < mesh->columns; i++)
        b->gate[i] = levels[i] >= least_ratio * level && levels[i] <= most_ratio * level;
}

/* Return v in cells, rounded up, at least 0. */
static int cell_from(int v) {
    return v <= 0 ? 0 : (v + BOX_CELL - 1) / BOX_CELL;
}

/* Return v in cells, rounded down, plus 1; at most `end`, 0 if v is negative. */
static int cell_end(int v, int end) {
    const int cells = v < 0 ? 0 : v / BOX_CELL + 1;
    return cells < end ? cells : end;
}

/* List the free stamps of n cells from column `column` on. */
static void list_cells(noise_boxes *b, int row, int column, int n) {
    const box_map *m = &b->sky->boxes;
    const uint8_t *is_free = box_map_row(m, row);
    const int32_t start = row * m->columns;
    for (int i = column; i < column + n; i++) {
        b->list[b->n] = start + i;
        b->n += is_free[i] & 1 & b->gate[b->mesh_column[i]];
    }
}

/* List the free stamps of a row of cells, in a range of columns. Most are not free, so that they
 * are looked at in eights. */
static void list_row(noise_boxes *b, int row, cell_range columns) {
    const uint8_t *is_free = box_map_row(&b->sky->boxes, row);
    int i = columns.first;
    for (uint64_t eight; i + (int)sizeof eight <= columns.end; i += (int)sizeof eight) {
        memcpy(&eight, is_free + i, sizeof eight);
        if ((eight & UINT64_C(0x0101010101010101)) != 0)
            list_cells(b, row, i, sizeof eight);
    }
    list_cells(b, row, i, columns.end - i);
}

/* Return the cells that begin on the amplifier of a pixel. */
static cell_range cells_of_amplifier(const amplifier_axis *axis, int pixel) {
    const int amplifier = amplifier_axis_at(axis, pixel);
    return (cell_range){cell_from(amplifier_axis_start(axis, amplifier)),
                        cell_from(amplifier_axis_start(axis, amplifier + 1))};
}

/* Return the cells of a range that begin at pixels first .. last. */
static cell_range cut_range(cell_range r, int first, int last) {
    const int from = cell_from(first);
    return (cell_range){from > r.first ? from : r.first, cell_end(last, r.end)};
}

void noise_boxes_find(noise_boxes *b, int x, int y, draw_key key) {
    const box_map *m = &b->sky->boxes;
    const noise_mesh *mesh = &b->sky->mesh;
    const int reach = reach_of(m);
    const int apart = m->stamp + m->frame;
    const int middle = m->stamp / 2;
    const double level = mesh->level[noise_mesh_at(mesh, x + middle, y + middle)];
    const cell_range columns = cells_of_amplifier(&m->x, x + middle);
    const cell_range rows = cut_range(cells_of_amplifier(&m->y, y + middle), y - reach, y + reach);
    int gate_row = -1;
    b->n = b->next = 0;
    b->key = key;
    for (int j = rows.first; j < rows.end; j++) {
        const int dy = j * BOX_CELL - y;
        const int half = (int)sqrt((double)reach * reach - (double)dy * dy);
        const cell_range row = cut_range(columns, x - half, x + half);
        if (noise_mesh_row(mesh, j * BOX_CELL + middle) != gate_row)
            set_gate(b, gate_row = noise_mesh_row(mesh, j * BOX_CELL + middle), level);
        if (abs(dy) >= apart) {
            list_row(b, j, row);
        } else {
            list_row(b, j, cut_range(row, 0, x - apart));
            list_row(b, j, cut_range(row, x + apart, m->x.pixels));
        }
    }
}

/* One step of a shuffle (Fisher and Yates): no box comes twice. */
bool noise_boxes_draw(noise_boxes *b, int *x, int *y) {
    if (b->next == b->n)
        return false;
    const uint32_t i = b->next + draw_index(b->key, b->next, b->n - b->next);
    const int32_t drawn = b->list[i];
    b->list[i] = b->list[b->next];
    b->list[b->next++] = drawn;
    *x = drawn % b->sky->boxes.columns * BOX_CELL;
    *y = drawn / b->sky->boxes.columns * BOX_CELL;
    return true;
}

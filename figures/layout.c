/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells of a grid. */
#include "internal.h"

/* Return the sum of the weights of cells [first, last), each 1 without weights. */
static double weight_of(const double *weights, int first, int last) {
    double sum = 0.0;
    for (int i = first; i < last; i++)
        sum += weights != NULL ? weights[i] : 1.0;
    return sum;
}

/* Compute the extent of cells [at, at + span) of n along one direction. */
static void cut(double start, double length, double gap, int n, const double *weights, int at,
                int span, double *out_start, double *out_length) {
    const double usable = length - gap * (n - 1);
    const double total = weight_of(weights, 0, n);
    *out_start = start + usable * weight_of(weights, 0, at) / total + gap * at;
    *out_length = usable * weight_of(weights, at, at + span) / total + gap * (span - 1);
}

shear_rect shear_grid_cell(const shear_grid *grid, int row, int column, int row_span,
                           int column_span) {
    shear_rect cell = {grid->area.x, grid->area.y, 0.0, 0.0};
    if (row < 0 || column < 0 || row_span < 1 || column_span < 1 || row_span > grid->rows - row ||
        column_span > grid->columns - column) {
        return cell;
    }
    cut(grid->area.x, grid->area.w, grid->gap_x, grid->columns, grid->column_weights, column,
        column_span, &cell.x, &cell.w);
    cut(grid->area.y, grid->area.h, grid->gap_y, grid->rows, grid->row_weights, row, row_span,
        &cell.y, &cell.h);
    return cell;
}

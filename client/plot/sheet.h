/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheet.h: the parts of the figure for a field file. */
#pragma once

#include "plot/array.h"
#include "plot/stamps.h"

enum { SHEET_COLUMNS = 6 };

/* Draw the headings of the columns; `y` is the middle of their first line. */
void sheet_draw_headings(shear_figure *f, const shear_grid *grid, double y, const stamp_reader *b);
/* Draw one stamp through all steps, in row `row` of the grid. */
int sheet_draw_stamp(shear_figure *f, const shear_grid *grid, int row, const stamp_reader *b,
                     const sheet_stamp *stamp, shear_error *err);
/* Draw the PSF, its transfer, the spectra's profiles and the plan side by side. `stamp` is the one
 * that was read last. */
int sheet_draw_plan(shear_figure *f, shear_rect area, const stamp_reader *b,
                    const sheet_stamp *stamp, shear_error *err);

/* Return the positions of an inspection's modes: k in radians per galaxy pixel. */
plot_lattice sheet_modes(const stamp_reader *b, const shear_inspection *steps);
/* Cut out the modes up to k_cut; those that are not used are NaN. */
int sheet_cut_modes(plot_cut *cut, const double *modes, const stamp_reader *b,
                    const shear_inspection *steps, shear_error *err);
/* Return the description of a square image of a cut, with a logarithmic colour scale; NaN is light
 * grey. */
shear_image sheet_cut_image(shear_rect cell, const char *title, const plot_cut *cut);

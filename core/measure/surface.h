/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/surface.h: interpolate a stamp or PSF to the fine grid, one strip of columns at a time.
 *
 * At the pixels the surface is defined by its value, its slopes along x and y, and the mixed slope
 * (in the sense of the axes' kind). These are stored transposed, [x][y]: a strip's columns are
 * interpolated along x with rows as lanes, the result along y with columns as lanes. */
#pragma once

#include "measure/axis.h"
#include "shear/settings.h"

/* How images of one shape are interpolated; immutable, shared by threads. */
typedef struct surface_grid {
    axis x, y;
    bool log;               /* interpolate ln(pixel + pedestal) */
    enum shear_zeros zeros; /* if log */
    double pedestal;
    double rounding; /* a negative pixel this small relative to the brightest counts as 0; may be
                        set to 0 */
    int fine_nx, fine_ny;
    size_t wide, high; /* nx and ny, rounded up to whole groups of FFT_LANES */
} surface_grid;

/* Place the grid, as axis_place does; interpolation is never AUTO. */
void surface_grid_place(surface_grid *g, int nx, int ny, enum shear_interpolation interpolation,
                        int s, enum shear_zeros zeros, double pedestal, arena *a);

typedef struct surface {
    const double *pixels;       /* [ny][nx] the loaded image; borrowed */
    double *rows, *row_slopes;  /* [high][wide] values or logarithms, and slopes along y */
    double *f, *fx, *fy, *fxy;  /* [wide][high], transposed */
    double *strip_f, *strip_fy; /* [high][FFT_LANES] a strip, fine along x, coarse along y */
    bool marked;                /* f holds marks: zero pixels under zeros=skip */
} surface;
void surface_place(surface *s, const surface_grid *g, arena *a);

/* Load the pixels [ny][nx], which the caller keeps until the strips have been made. Return false if
 * a log method meets a negative number, at pixel (*bad_x, *bad_y). */
bool surface_load(surface *s, const surface_grid *g, const double *pixels, int *bad_x, int *bad_y);

/* Interpolate columns [x0, x0 + FFT_LANES) of fine rows [y0, y1) into out[fine_ny][FFT_LANES];
 * columns beyond the last are undefined. Changes the scratch of *s. */
void surface_strip(surface *s, const surface_grid *g, int x0, int y0, int y1, double *out);

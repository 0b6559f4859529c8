/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/surface.h: a stamp (or PSF) on its way to the fine grid, one strip of columns at a time.
 *
 * At the pixels the surface is fixed by its value, its slopes along x and y and the mixed one
 * (whatever the axes' kind calls a slope). These are kept transposed, [x][y]: a strip's columns are
 * interpolated along x with the rows for lanes, the result along y with the columns for lanes.
 */
#ifndef SHEAR_MEASURE_SURFACE_H
#define SHEAR_MEASURE_SURFACE_H

#include "measure/axis.h"
#include "shear/settings.h"

/* How images of one shape are interpolated; immutable, shared by threads. */
typedef struct surface_grid {
    axis x, y;
    bool log;               /* interpolate ln(pixel + pedestal) */
    enum shear_zeros zeros; /* where log */
    double pedestal;
    double rounding; /* a negative pixel this small beside the brightest counts as 0; set to 0 */
    int fine_nx, fine_ny;
    size_t wide, high; /* nx and ny, rounded up to whole groups of FFT_LANES */
} surface_grid;

/* interpolation: never AUTO. false when memory is out; deinit is safe then too. */
bool surface_grid_init(surface_grid *g, int nx, int ny, enum shear_interpolation interpolation,
                       int s, enum shear_zeros zeros, double pedestal);
void surface_grid_deinit(surface_grid *g);

typedef struct surface {
    const double *pixels;       /* [ny][nx] of the image being worked on */
    double *rows, *row_slopes;  /* [high][wide] values or logarithms, and slopes along y */
    double *f, *fx, *fy, *fxy;  /* [wide][high], transposed */
    double *strip_f, *strip_fy; /* [high][FFT_LANES] a strip, fine along x, coarse along y */
    bool marked;                /* f holds marks: zeros under zeros=skip */
} surface;
bool surface_init(surface *s, const surface_grid *g);
void surface_deinit(surface *s);

/* Take up the pixels [ny][nx] (kept by the caller until the strips have been made). false where a
 * log method meets a negative number: pixel (*bad_x, *bad_y). */
bool surface_load(surface *s, const surface_grid *g, const double *pixels, int *bad_x, int *bad_y);

/* Columns [x0, x0 + FFT_LANES) of fine rows [y0, y1), into out[fine_ny][FFT_LANES]; columns beyond
 * the last hold nothing of use. Changes the scratch of *s. */
void surface_strip(surface *s, const surface_grid *g, int x0, int y0, int y1, double *out);

#endif

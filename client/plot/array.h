/* SPDX-License-Identifier: GPL-3.0-or-later */
/* array.h: cuts through images and spectra. */
#ifndef CLIENT_PLOT_ARRAY_H
#define CLIENT_PLOT_ARRAY_H

#include "shear/error.h"
#include "shear_figures/scale.h"

/* A rectangle cut out of an array [ny][nx], with the coordinates of its outer edges. */
typedef struct plot_cut {
    int nx, ny;
    double *pixels; /* [ny][nx], owned; NULL = none */
    shear_range x, y;
} plot_cut;

/* Where the samples of an array lie: sample (i, j) at ((i - x0) step_x, (j - y0) step_y). */
typedef struct plot_lattice {
    int nx, ny;
    double x0, y0;
    double step_x, step_y;
} plot_lattice;

/* Cut out all samples with |x|, |y| <= reach (all of them where reach is not finite). */
int plot_cut_init(plot_cut *cut, const double *array, const plot_lattice *lattice, double reach,
                  shear_error *err);
void plot_cut_deinit(plot_cut *cut);
/* Of its finite samples. */
shear_range plot_cut_range(const plot_cut *cut);

/* out[bins] = mean of the array's samples with radius in [b - 1/2, b + 1/2) * width from the
 * origin; NaN if there is none. */
int plot_radial_mean(double *out, int bins, double width, const double *array,
                     const plot_lattice *lattice, shear_error *err);

/* The middle of the samples above exp(-1/2) of the peak, in sample indices, of array[ny][nx]; the
 * array's middle if it has no positive sample. */
void plot_core_centre(const double *array, int nx, int ny, double *x, double *y);

#endif

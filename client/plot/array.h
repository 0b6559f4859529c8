/* SPDX-License-Identifier: GPL-3.0-or-later */
/* array.h: cut-outs and profiles of images and spectra. */
#pragma once

#include "shear/error.h"
#include "shear_figures/scale.h"

/* A rectangle of an array [ny][nx], with the coordinates of its outer edges. */
typedef struct plot_cut {
    int nx, ny;
    double *pixels; /* [ny][nx], owned; NULL: none */
    shear_range x, y;
} plot_cut;

/* The positions of an array's samples: sample (i, j) is at ((i - x0) step_x, (j - y0) step_y). */
typedef struct plot_lattice {
    int nx, ny;
    double x0, y0;
    double step_x, step_y;
} plot_lattice;

/* Cut out all samples with |x|, |y| <= reach, or all samples if reach is not finite. Returns
 * SHEAR_OK or an error code. */
int plot_cut_init(plot_cut *cut, const double *array, const plot_lattice *lattice, double reach,
                  shear_error *err);
void plot_cut_deinit(plot_cut *cut);
/* Return the range of the finite samples of `cut`. */
shear_range plot_cut_range(const plot_cut *cut);

/* Set out[bins] to the mean of the samples with radius in [b - 1/2, b + 1/2) * width from the
 * origin, NaN if there are none. Returns SHEAR_OK or an error code. */
int plot_radial_mean(double *out, int bins, double width, const double *array,
                     const plot_lattice *lattice, shear_error *err);

/* Set (*x, *y) to the centre of the samples above exp(-1/2) of the peak of array[ny][nx], in sample
 * indices; to the array's centre if no sample is positive. */
void plot_core_centre(const double *array, int nx, int ny, double *x, double *y);

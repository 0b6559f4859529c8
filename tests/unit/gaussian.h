/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/gaussian.h: Gaussian images, whose moments are known exactly. */
#pragma once

#include "shear/stamp.h"

/* A exp(-r^T C^-1 r / 2), with C = [xx xy; xy yy] in square pixels, centred at (x0, y0). */
typedef struct gaussian {
    double amplitude, xx, yy, xy, x0, y0;
} gaussian;

/* Draw on nx x ny samples, `per_pixel` of them a pixel, centre (x0, y0) in pixels from the first
 * sample. */
void gaussian_draw(const gaussian *g, int nx, int ny, int per_pixel, double *out);

/* The row that must come out for galaxy `g` (PSF included) and PSF `psf` carried to an isotropic
 * Gaussian of scale beta: only n1 ... m4 are set. */
shear_row gaussian_row(const gaussian *g, const gaussian *psf, double beta);

/* |a - b| <= tolerance * scale, reported with both numbers. */
void assert_near(double a, double b, double tolerance, double scale, const char *what);
/* All moments and terms of two rows, relative to d and (for fourth-order ones) m4. */
void assert_rows_near(const shear_row *a, const shear_row *b, double tolerance);

/* n rows are equal to the last bit, NaNs included, their numbers in their files aside. */
void assert_same_rows(const shear_row *a, const shear_row *b, int n);

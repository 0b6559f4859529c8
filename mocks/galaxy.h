/* SPDX-License-Identifier: GPL-3.0-or-later */
/* galaxy.h: the point sources of one galaxy, relative to its centre, and their rotation and
 * lensing. */
#pragma once

#include "shear_mocks/mock.h"

#include <stdint.h>

/* Return the maximum number of points of a galaxy, which is also the nominal number: a random walk
 * loses the joints beyond R_G. */
int galaxy_max_points(const shear_mock_spec *s);

/* Compute the points of galaxy `index` before rotation and lensing: x, y [max_points], px. Returns
 * the number of points. */
int galaxy_points(const shear_mock_spec *s, int64_t index, double *x, double *y);

/* Rotate the points by eighths * 45 degrees, from x towards y. Multiples of 90 degrees are exact.
 */
void galaxy_rotate(int eighths, int n, double *x, double *y);

/* Lens the points: x' = (1+g1) x + g2 y,  y' = g2 x + (1-g1) y. */
void galaxy_lens(double g1, double g2, int n, double *x, double *y);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* galaxy.h: the points of one galaxy, relative to its centre. */
#ifndef MOCKS_GALAXY_H
#define MOCKS_GALAXY_H

#include "shear_mocks/mock.h"

#include <stdint.h>

/* A galaxy has at most so many points, and nominally as many: a random walk loses the joints beyond
 * R_G. */
int galaxy_max_points(const shear_mock_spec *s);

/* Galaxy number `index`, before rotation and lensing: x, y [max_points]. Returns the number of
 * points. */
int galaxy_points(const shear_mock_spec *s, int64_t index, double *x, double *y);

/* Turn the points by eighths * 45 degrees, from x towards y. Quarter turns are exact. */
void galaxy_rotate(int eighths, int n, double *x, double *y);

/* x' = (1+g1) x + g2 y,  y' = g2 x + (1-g1) y. */
void galaxy_lens(double g1, double g2, int n, double *x, double *y);

#endif

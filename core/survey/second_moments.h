/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/second_moments.h: the covariance of the Gaussian that fits an image best. */
#pragma once

#include <stdbool.h>

/* Compute the adaptive moments of image[ny][nx], xx, xy, yy in square samples: those under a
 * Gaussian weight of the same centre and covariance, times 2 (Bernstein & Jarvis 2002). Return
 * false if the image has none: no peak, or no Gaussian that fits. */
bool second_moments(const double *image, int nx, int ny, double cov[3]);

/* Convert the covariance k of |W|^2 to that of the Gaussian W, C = (2 k)^-1: |W|^2 is the
 * exponential of -k^T C k. */
void second_moments_of_power(double k[3]);
/* Carry a covariance along u and v to pixels, J^-1 C J^-T; j: du/dx, du/dy, dv/dx, dv/dy. */
void second_moments_to_pixels(double c[3], const double j[4]);

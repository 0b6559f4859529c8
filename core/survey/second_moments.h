/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/second_moments.h: the covariance of the Gaussian that fits an image best. */
#pragma once

#include <stdbool.h>

/* Compute the adaptive moments of image[ny][nx], xx, xy, yy in square samples: those under a
 * Gaussian weight of the same centre and covariance, times 2 (Bernstein & Jarvis 2002). Return
 * false if the image has none: no peak, or no Gaussian that fits. */
bool second_moments(const double *image, int nx, int ny, double cov[3]);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/half_light.h: the half-light radius of a PSF image. */
#pragma once

/* Return the radius about the brightest sample of image[ny][nx] that holds half of the sum, in
 * samples; NaN if the sum is not positive. */
double half_light(const double *image, int nx, int ny);

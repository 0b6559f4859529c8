/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/half_light.h: half-light radii, of a PSF and of the stars that it should be as large as.
 */
#pragma once

#include "survey/sources/source_list.h"

/* Return the radius about the centre of image[ny][nx] within which half of its light is, samples;
 * NaN if it has no light. */
double half_light_of_image(const double *image, int nx, int ny);

/* Return the FLUX_RADIUS of the stars of a catalog, pixels: of the sources that are not selected,
 * if they are 20 or more, most of them smaller than nine in ten of those that are, and the quarter
 * around their lower quartile equal to 5 %. That is what leaving stars out looks like. NaN: the
 * stars are not known; or out of memory. */
double half_light_of_stars(const source_list *sources);

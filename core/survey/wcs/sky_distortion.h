/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/sky_distortion.h: what a sky map does to shapes: shear, scale, rotation, parity. */
#pragma once

#include <stdbool.h>

/* The parts of a Jacobian j = (du/dx, du/dy, dv/dx, dv/dy), u to the West, v to the North:
 *
 *     (u, v) = scale P R(rotation) S^-1 (x, y),    S = (1 + g1, g2; g2, 1 - g1)/sqrt(1 - g1^2 -
 * g2^2)
 *
 * R turns x towards y, P is diag(-1, 1) if the map is mirrored, else 1. An object that is round on
 * the sky has the shear (g1, g2) in the pixel frame (docs/method.md). */
typedef struct sky_distortion {
    double g1, g2;
    double scale;    /* sqrt|det J|, arcsec per pixel */
    double rotation; /* radians, from u to v, of the pixels' x axis */
    bool mirrored;   /* det J < 0 */
} sky_distortion;

/* NaN for what a singular Jacobian has not. */
sky_distortion sky_distortion_of(const double j[4]);

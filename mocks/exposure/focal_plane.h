/* SPDX-License-Identifier: GPL-3.0-or-later */
/* focal_plane.h: where a chip's pixels are in the field and on the sky. */
#pragma once

#include "shear_mocks/exposure.h"

typedef struct focal_plane {
    double cd[4];           /* CD1_1, CD1_2, CD2_1, CD2_2, degrees per pixel */
    double skew1, skew2, k; /* the polynomial of exposure.h, note 4; k in degrees^-2 */
    double ra, dec;         /* of the field's centre, radians */
    double half_x, half_y;  /* half sides of the field, pixels */
} focal_plane;

/* The place of a chip: its pixel (x, y) is (x - crpix_x, y - crpix_y) from the field's centre. */
typedef struct chip_place {
    double crpix_x, crpix_y;
} chip_place;

/* A place on the sky, degrees, and the Jacobian (du/dx, du/dy, dv/dx, dv/dy), arcsec per pixel, u
 * to the West and v to the North in the tangent plane at that place. */
typedef struct sky_place {
    double ra, dec;
    double j[4];
} sky_place;

focal_plane focal_plane_make(const shear_mock_exposure *e);
/* Return the place of chip `i`, which are counted along x first. */
chip_place focal_plane_chip(const shear_mock_exposure *e, int i);
/* Return whether the coordinates are more than TAN: TPV. */
bool focal_plane_distorted(const focal_plane *f);
/* Compute the sky at (dx, dy) pixels from the field's centre. */
sky_place focal_plane_sky(const focal_plane *f, double dx, double dy);

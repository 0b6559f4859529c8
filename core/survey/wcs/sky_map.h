/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/sky_map.h: from pixels to the sky and back, by wcslib.
 *
 * A map is used by one thread at a time: wcslib's conversions write into their own struct, and two
 * threads that share one get wrong positions silently. Threads may make and use maps of their own.
 * Pixel positions count from 1 (FITS), angles are degrees. */
#pragma once

#include "shear/error.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct sky_map sky_map;

/* Make the map from `count` header cards of 80 characters; `where` names the file and HDU in
 * messages. *map is NULL, without an error, if the cards have no celestial coordinates. TAN with PV
 * coefficients (SCAMP) is read as TPV; with SIP they are ignored. SHEAR_E_FORMAT: coordinates that
 * sky_keywords_read or wcslib refuses; SHEAR_E_NOMEM. */
int sky_map_new(sky_map **map, const char *cards, int64_t count, const char *where,
                shear_error *err);
void sky_map_free(sky_map *map);

/* Convert n positions; those that have no place become NaN. RA is from 0 to 360. Pixels may lie
 * outside the image; they are returned only if they lead back to the position within 1e-8 degrees.
 */
void sky_map_to_sky(sky_map *map, int64_t n, const double *x, const double *y, double *ra,
                    double *dec);
void sky_map_to_pixel(sky_map *map, int64_t n, const double *ra, const double *dec, double *x,
                      double *y);

/* Compute j = (du/dx, du/dy, dv/dx, dv/dy), arcsec per pixel, at pixel (x, y): u to the West, v to
 * the North, in the tangent plane at that very place. Return false if it has no place on the sky,
 * or the map is singular there. */
bool sky_map_jacobian(sky_map *map, double x, double y, double j[4]);
/* Compute (u, v), arcsec, of a position in the tangent plane at (ra0, dec0), degrees. Return false
 * beyond 90 degrees. */
bool sky_map_tangent(double ra, double dec, double ra0, double dec0, double *u, double *v);

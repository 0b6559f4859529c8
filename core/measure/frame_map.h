/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/frame_map.h: the linear map from a galaxy's pixels to the frame of the moments
 * (docs/method.md, section 4.1). */
#pragma once

#include "shear/plan.h"

#include <stdbool.h>

/* With J the Jacobian of the frame's coordinates by the pixels', q = J^-T k. */
typedef struct frame_map {
    double a[4];       /* J^-T: qx = a[0] kx + a[1] ky, qy = a[2] kx + a[3] ky */
    double area;       /* |det J| */
    double stretch;    /* the larger singular value of J: |q| >= |k| / stretch */
    double xx, xy, yy; /* |q|^2 = xx kx^2 + 2 xy kx ky + yy ky^2 */
} frame_map;

/* The map of the pixel frame. */
extern const frame_map frame_map_pixel;

/* Make the map from du/dx, du/dy, dv/dx, dv/dy (u to the West). Return false if they are not a map:
 * not finite, singular, or pixels that are more than three times as long as wide. */
bool frame_map_make(frame_map *m, const double *jacobian, enum shear_frame frame);

/* Return the largest |kx| (of modes with |q| <= q) in rows of this ky >= 0 or a larger one; 0 if
 * there is none. */
double frame_map_kx(const frame_map *m, double q, double ky);
/* Return the largest |ky| of modes with |q| <= q. */
double frame_map_ky(const frame_map *m, double q);

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/near_chip.h"

#include <math.h>
#include <stdbool.h>

enum { POINTS = 9 };
static const double factor = 1.5;
static const double margin_deg = 2.0 / 60.0;

/* Find the chip's middle, and the distance of its farthest corner, degrees. Return false if some of
 * the chip has no place on the sky. */
static bool find_middle(sky_map *map, int nx, int ny, source_cap *middle, double *corner) {
    double x[POINTS];
    double y[POINTS];
    double ra[POINTS];
    double dec[POINTS];
    for (int i = 0; i < POINTS; i++) {
        x[i] = 0.5 + 0.5 * nx * (i % 3);
        y[i] = 0.5 + 0.5 * ny * (i / 3 % 3);
    }
    sky_map_to_sky(map, POINTS, x, y, ra, dec);
    *corner = 0.0;
    *middle = source_cap_about(ra[POINTS / 2], dec[POINTS / 2]);
    for (int i = 0; i < POINTS; i++) {
        if (isnan(ra[i]))
            return false;
        *corner = fmax(*corner, source_cap_distance(middle, ra[i], dec[i]));
    }
    return true;
}

source_cap near_chip_cap(sky_map *map, int nx, int ny, near_chip *found) {
    source_cap cap;
    double corner;
    const bool placed = find_middle(map, nx, ny, &cap, &corner);
    if (placed)
        cap.radius = factor * corner + margin_deg;
    *found = (near_chip){INFINITY, placed ? corner : NAN};
    return cap;
}

void near_chip_measure(near_chip *found, const source_cap *cap) {
    if (!isnan(found->corner_deg))
        found->nearest_deg = cap->nearest;
}

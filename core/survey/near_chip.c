/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/near_chip.h"

#include "base/cleanup.h"
#include "common/release.h"

#include <math.h>
#include <stdlib.h>

enum { POINTS = 9 };
static const double factor = 1.5;
static const double margin_deg = 2.0 / 60.0;
static const double degree = M_PI / 180.0;

typedef struct direction {
    double x, y, z;
} direction;

static direction direction_of(double ra, double dec) {
    const double c = cos(dec * degree);
    return (direction){c * cos(ra * degree), c * sin(ra * degree), sin(dec * degree)};
}

static double cosine(direction a, direction b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Find the chip's middle, and the cosine of the distance from it within which sources remain.
 * Return false if some of the chip has no place on the sky. */
static bool find_cap(sky_map *map, int nx, int ny, direction *middle, double *least) {
    double x[POINTS];
    double y[POINTS];
    double ra[POINTS];
    double dec[POINTS];
    double farthest = 1.0;
    for (int i = 0; i < POINTS; i++) {
        x[i] = 0.5 + 0.5 * nx * (i % 3);
        y[i] = 0.5 + 0.5 * ny * (i / 3 % 3);
    }
    sky_map_to_sky(map, POINTS, x, y, ra, dec);
    *middle = direction_of(ra[POINTS / 2], dec[POINTS / 2]);
    for (int i = 0; i < POINTS; i++) {
        if (isnan(ra[i]))
            return false;
        farthest = fmin(farthest, cosine(*middle, direction_of(ra[i], dec[i])));
    }
    const double reach = factor * acos(fmax(-1.0, farthest)) + margin_deg * degree;
    *least = cos(fmin(reach, M_PI));
    return true;
}

int near_chip_keep(source_list *sources, sky_map *map, int nx, int ny, shear_error *err) {
    direction middle;
    double least = -1.0;
    if (!find_cap(map, nx, ny, &middle, &least))
        return SHEAR_OK;
    CLEANUP(release_free) int64_t *near = calloc((size_t)sources->n + 1, sizeof *near);
    if (near == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the sources of a chip");
    for (int64_t i = 0; i < sources->n; i++)
        near[i] = cosine(middle, direction_of(sources->ra[i], sources->dec[i])) >= least;
    source_list_keep(sources, near, 1);
    return SHEAR_OK;
}

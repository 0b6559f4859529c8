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

/* Find the chip's middle, and the distance of its farthest corner, radians. Return false if some of
 * the chip has no place on the sky. */
static bool find_cap(sky_map *map, int nx, int ny, direction *middle, double *corner) {
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
    *corner = acos(fmax(-1.0, farthest));
    return true;
}

int near_chip_keep(source_list *sources, sky_map *map, int nx, int ny, near_chip *found,
                   shear_error *err) {
    direction middle;
    double corner = NAN;
    double nearest = -2.0;
    const bool placed = find_cap(map, nx, ny, &middle, &corner);
    const double least = cos(fmin(factor * corner + margin_deg * degree, M_PI));
    CLEANUP(release_free) int64_t *near = calloc((size_t)sources->n + 1, sizeof *near);
    if (near == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the sources of a chip");
    for (int64_t i = 0; i < sources->n; i++) {
        const double c = cosine(middle, direction_of(sources->ra[i], sources->dec[i]));
        near[i] = !placed || c >= least;
        nearest = fmax(nearest, c); /* which is not NaN */
    }
    *found = (near_chip){placed && nearest >= -1.5 ? acos(fmin(nearest, 1.0)) / degree : INFINITY,
                         corner / degree};
    source_list_keep(sources, near, 1);
    return SHEAR_OK;
}

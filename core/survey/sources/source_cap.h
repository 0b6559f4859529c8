/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/source_cap.h: a cap of the sky: of a catalog of many chips, only the sources near
 * one of them are loaded. */
#pragma once

#include <math.h>
#include <stdbool.h>

/* Lengths in degrees. */
typedef struct source_cap {
    double x, y, z, dec; /* direction of its middle */
    double radius;       /* INFINITY: all the sky, and what has no place on it */
    double nearest;      /* distance of the nearest source that was seen; INFINITY: none was */
} source_cap;

/* Return the whole sky, about a place in degrees. */
static inline source_cap source_cap_about(double ra, double dec) {
    const double degree = M_PI / 180.0;
    const double c = cos(dec * degree);
    return (source_cap){.x = c * cos(ra * degree),
                        .y = c * sin(ra * degree),
                        .z = sin(dec * degree),
                        .dec = dec,
                        .radius = INFINITY,
                        .nearest = INFINITY};
}

/* Return the distance of a place from the middle, degrees. */
static inline double source_cap_distance(const source_cap *c, double ra, double dec) {
    const source_cap other = source_cap_about(ra, dec);
    const double cosine = c->x * other.x + c->y * other.y + c->z * other.z;
    return acos(cosine > 1.0 ? 1.0 : cosine < -1.0 ? -1.0 : cosine) * 180.0 / M_PI;
}

/* See a source, and return whether it is in the cap. Most need no sines: they are not nearer than
 * their declination is. */
static inline bool source_cap_sees(source_cap *c, double ra, double dec) {
    const double least = fabs(dec - c->dec);
    if (least > c->radius && least > c->nearest)
        return false;
    const double distance = source_cap_distance(c, ra, dec);
    if (distance < c->nearest)
        c->nearest = distance;
    return isinf(c->radius) || distance <= c->radius;
}

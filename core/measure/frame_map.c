/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/frame_map.h"

#include <math.h>

const frame_map frame_map_pixel = {
    .a = {1.0, 0.0, 0.0, 1.0}, .area = 1.0, .stretch = 1.0, .xx = 1.0, .xy = 0.0, .yy = 1.0};

/* The longest pixel, relative to its width. Tables of the target underflow, rather than overflow,
 * up to here; no optics distorts as much. */
static const double longest = 3.0;

bool frame_map_make(frame_map *m, const double *jacobian, enum shear_frame frame) {
    const double east = frame == SHEAR_FRAME_SKY_EAST ? -1.0 : 1.0;
    const double ux = east * jacobian[0];
    const double uy = east * jacobian[1];
    const double vx = jacobian[2];
    const double vy = jacobian[3];
    /* Twice the mean and half the difference of the singular values, up to the sign of det J. */
    const double one = hypot(ux + vy, uy - vx);
    const double other = hypot(ux - vy, uy + vx);
    const double large = 0.5 * (one + other);
    const double small = 0.5 * fabs(one - other);
    const double det = ux * vy - uy * vx;
    if (!(small > 0.0) || !(large <= longest * small) || !isnormal(det) || !isnormal(1.0 / det))
        return false;
    *m = (frame_map){
        .a = {vy / det, -vx / det, -uy / det, ux / det}, .area = fabs(det), .stretch = large};
    m->xx = m->a[0] * m->a[0] + m->a[2] * m->a[2];
    m->xy = m->a[0] * m->a[1] + m->a[2] * m->a[3];
    m->yy = m->a[1] * m->a[1] + m->a[3] * m->a[3];
    return isnormal(m->xx) && isnormal(m->yy);
}

static double determinant(const frame_map *m) {
    return m->xx * m->yy - m->xy * m->xy;
}

double frame_map_ky(const frame_map *m, double q) {
    return q * sqrt(m->xx / determinant(m));
}

/* The circle |q| is an ellipse of k, which may lean: its widest row is not ky = 0. */
double frame_map_kx(const frame_map *m, double q, double ky) {
    const double widest = q * sqrt(m->yy / determinant(m));
    if (ky <= fabs(m->xy) / m->yy * widest)
        return widest;
    const double left = m->xx * q * q - determinant(m) * ky * ky;
    return left > 0.0 ? (fabs(m->xy) * ky + sqrt(left)) / m->xx : 0.0;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/plane.h: a plane c + cx x + cy y through weighted values, by least squares. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct plane {
    double c, cx, cy;
} plane;

/* Weighted sums over values v at (x, y). {0}: none yet. */
typedef struct plane_sums {
    double n, x, y, xx, xy, yy; /* sums of w, w x, ... */
    double v, xv, yv, vv;
} plane_sums;

static inline void plane_add(plane_sums *s, double x, double y, double v, double w) {
    const double wx = w * x;
    const double wy = w * y;
    const double wv = w * v;
    s->n += w;
    s->x += wx;
    s->y += wy;
    s->xx += wx * x;
    s->xy += wx * y;
    s->yy += wy * y;
    s->v += wv;
    s->xv += wv * x;
    s->yv += wv * y;
    s->vv += wv * v;
}

static inline double plane_at(const plane *p, double x, double y) {
    return p->c + p->cx * x + p->cy * y;
}

/* Subtract the plane from n pixels of row y, from column x on. */
void plane_subtract(const plane *p, int x, int y, const double *restrict row, int n,
                    double *restrict out);

/* Fit the plane. *chi2 (may be NULL) is the weighted sum of the squares of the residuals. False if
 * the values lie on a line, or are none. */
bool plane_fit(const plane_sums *s, plane *p, double *chi2);

/* Fit the plane to the frame of a box, value[side][side], `frame` pixels wide, in pixels from the
 * first of the box. Those with away[side][side] not 0 are left out. Faint sources are not clipped:
 * that would bias the mean. False: fewer than 30 % of the frame are left. */
bool plane_of_frame(plane *p, const double *value, const uint8_t *away, int side, int frame);

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/plane.h"

#include "base/simd.h"

#include <stddef.h>

enum { LEAST_PERCENT = 30 };

/* Solve the normal equations about the centre of the points, where c separates from the slopes. */
bool plane_fit(const plane_sums *s, plane *p, double *chi2) {
    if (!(s->n > 0.0))
        return false;
    const double mx = s->x / s->n;
    const double my = s->y / s->n;
    const double xx = s->xx - mx * s->x;
    const double xy = s->xy - mx * s->y;
    const double yy = s->yy - my * s->y;
    const double xv = s->xv - mx * s->v;
    const double yv = s->yv - my * s->v;
    const double det = xx * yy - xy * xy;
    if (!(det > 1e-9 * s->xx * s->yy))
        return false;
    p->cx = (xv * yy - yv * xy) / det;
    p->cy = (yv * xx - xv * xy) / det;
    p->c = s->v / s->n - p->cx * mx - p->cy * my;
    if (chi2 != NULL) {
        const double rest = s->vv - s->v * s->v / s->n - p->cx * xv - p->cy * yv;
        *chi2 = rest > 0.0 ? rest : 0.0;
    }
    return true;
}

SHEAR_SIMD void plane_subtract(const plane *p, int x, int y, const double *restrict row, int n,
                               double *restrict out) {
    const double start = plane_at(p, x, y);
    const double slope = p->cx;
#pragma omp simd
    for (int i = 0; i < n; i++)
        out[i] = row[i] - (start + slope * i);
}

/* Sums in lanes, which are vectors on any machine and the same to the last bit. */
enum { LANES = 8 };
typedef struct lane_sums {
    double n[LANES], x[LANES], y[LANES], xx[LANES], xy[LANES], yy[LANES];
    double v[LANES], xv[LANES], yv[LANES];
} lane_sums;

/* Add `n` pixels from column x of row y, at most LANES. */
static SHEAR_INLINE void add_lanes(lane_sums *s, const double *row, const uint8_t *away, int x,
                                   int y, int n) {
#pragma omp simd
    for (int l = 0; l < n; l++) {
        const double w = away[x + l] == 0 ? 1.0 : 0.0;
        const double v = away[x + l] == 0 ? row[x + l] : 0.0; /* which may be NaN */
        const double wx = w * (x + l);
        s->n[l] += w;
        s->x[l] += wx;
        s->y[l] += w * y;
        s->xx[l] += wx * (x + l);
        s->xy[l] += wx * y;
        s->yy[l] += w * y * y;
        s->v[l] += v;
        s->xv[l] += v * (x + l);
        s->yv[l] += v * y;
    }
}

SHEAR_SIMD static void add_row(lane_sums *s, const double *row, const uint8_t *away, int y, int x,
                               int end) {
    for (; x + LANES <= end; x += LANES)
        add_lanes(s, row, away, x, y, LANES);
    add_lanes(s, row, away, x, y, end - x);
}

static plane_sums joined(const lane_sums *s) {
    plane_sums sums = {0};
    for (int l = 0; l < LANES; l++) {
        sums.n += s->n[l];
        sums.x += s->x[l];
        sums.y += s->y[l];
        sums.xx += s->xx[l];
        sums.xy += s->xy[l];
        sums.yy += s->yy[l];
        sums.v += s->v[l];
        sums.xv += s->xv[l];
        sums.yv += s->yv[l];
    }
    return sums;
}

bool plane_of_frame(plane *p, const double *value, const uint8_t *away, int side, int frame) {
    const int inside = side - 2 * frame;
    lane_sums lanes = {0};
    for (int y = 0; y < side; y++) {
        const double *row = value + (ptrdiff_t)y * side;
        const uint8_t *a = away + (ptrdiff_t)y * side;
        const bool across = y < frame || y >= frame + inside;
        add_row(&lanes, row, a, y, 0, across ? side : frame);
        if (!across)
            add_row(&lanes, row, a, y, frame + inside, side);
    }
    const plane_sums sums = joined(&lanes);
    return sums.n * 100.0 >= (double)(side * side - inside * inside) * LEAST_PERCENT &&
           plane_fit(&sums, p, NULL);
}

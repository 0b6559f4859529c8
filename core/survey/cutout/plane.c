/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/plane.h"

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

/* Add the pixels of row y from column x to end-1; return how many. */
static int add_row(plane_sums *sums, const double *row, const uint8_t *away, int y, int x,
                   int end) {
    int n = 0;
    for (; x < end; x++) {
        if (away[x] == 0) {
            plane_add(sums, x, y, row[x], 1.0);
            n++;
        }
    }
    return n;
}

bool plane_of_frame(plane *p, const double *value, const uint8_t *away, int side, int frame) {
    const int inside = side - 2 * frame;
    plane_sums sums = {0};
    int n = 0;
    for (int y = 0; y < side; y++) {
        const double *row = value + (ptrdiff_t)y * side;
        const uint8_t *a = away + (ptrdiff_t)y * side;
        if (y < frame || y >= frame + inside) {
            n += add_row(&sums, row, a, y, 0, side);
        } else {
            n += add_row(&sums, row, a, y, 0, frame);
            n += add_row(&sums, row, a, y, frame + inside, side);
        }
    }
    return n * 100 >= (side * side - inside * inside) * LEAST_PERCENT && plane_fit(&sums, p, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/plane.h"

#include "base/simd.h"

#include <stddef.h>
#include <string.h>

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

/* Sums in lanes: vectors of the compilers' own, lowered to what the machine has, and the same to
 * the last bit on all. (Loops over the lanes of an array become no vectors here.) */
enum { LANES = 8 };
typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
typedef int64_t lane_masks __attribute__((vector_size(LANES * sizeof(int64_t))));
typedef uint8_t lane_bytes __attribute__((vector_size(LANES)));
typedef struct lane_sums {
    lanes n, x, y, xx, xy, yy, v, xv, yv;
} lane_sums;

/* Add LANES pixels from column x of row y. */
static SHEAR_INLINE void add_lanes(lane_sums *s, const double *row, const uint8_t *away, int x,
                                   int y) {
    static const lanes column = {0, 1, 2, 3, 4, 5, 6, 7};
    static const lanes one = {1, 1, 1, 1, 1, 1, 1, 1};
    lane_bytes bytes;
    lane_masks pixels;
    memcpy(&bytes, away, sizeof bytes);
    memcpy(&pixels, row, sizeof pixels);
    const lane_masks used = __builtin_convertvector(bytes == 0, lane_masks);
    const lanes v = (lanes)(pixels & used); /* without NaN */
    const lanes w = (lanes)((lane_masks)one & used);
    const lanes at = column + (double)x;
    const lanes wx = w * at;
    s->n += w;
    s->x += wx;
    s->y += w * (double)y;
    s->xx += wx * at;
    s->xy += wx * (double)y;
    s->yy += w * (double)y * (double)y;
    s->v += v;
    s->xv += v * at;
    s->yv += v * (double)y;
}

/* Add the pixels of columns x .. end-1. */
static SHEAR_INLINE void add_row(lane_sums *s, const double *row, const uint8_t *away, int y, int x,
                                 int end) {
    for (; x + LANES <= end; x += LANES)
        add_lanes(s, row + x, away + x, x, y);
    if (x < end) {
        double rest[LANES] = {0.0};
        uint8_t marks[LANES];
        memset(marks, 1, sizeof marks);
        memcpy(rest, row + x, (size_t)(end - x) * sizeof *rest);
        memcpy(marks, away + x, (size_t)(end - x));
        add_lanes(s, rest, marks, x, y);
    }
}

static double sum_of(const lanes *v) {
    double sum = 0.0;
    for (int l = 0; l < LANES; l++)
        sum += (*v)[l];
    return sum;
}

/* Add up the frame. */
SHEAR_SIMD static void add_frame(plane_sums *sums, const double *value, const uint8_t *away,
                                 int side, int frame) {
    const int inside = side - 2 * frame;
    lane_sums s = {0};
    for (int y = 0; y < side; y++) {
        const double *row = value + (ptrdiff_t)y * side;
        const uint8_t *a = away + (ptrdiff_t)y * side;
        const bool across = y < frame || y >= frame + inside;
        add_row(&s, row, a, y, 0, across ? side : frame);
        if (!across)
            add_row(&s, row, a, y, frame + inside, side);
    }
    *sums = (plane_sums){.n = sum_of(&s.n),
                         .x = sum_of(&s.x),
                         .y = sum_of(&s.y),
                         .xx = sum_of(&s.xx),
                         .xy = sum_of(&s.xy),
                         .yy = sum_of(&s.yy),
                         .v = sum_of(&s.v),
                         .xv = sum_of(&s.xv),
                         .yv = sum_of(&s.yv)};
}

bool plane_of_frame(plane *p, const double *value, const uint8_t *away, int side, int frame) {
    const int inside = side - 2 * frame;
    plane_sums sums;
    add_frame(&sums, value, away, side, frame);
    return sums.n * 100.0 >= (double)(side * side - inside * inside) * LEAST_PERCENT &&
           plane_fit(&sums, p, NULL);
}

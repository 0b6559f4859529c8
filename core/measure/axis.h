/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/axis.h: interpolation along one axis.
 *
 * All of the paper's methods are separable: bicubic with the paper's mixed derivative is a cubic
 * Hermite interpolation along x, then along y; the 2-D spline is defined that way.
 *
 * On the cell between grid points i and i+1, at t = 0, 1/s, ... (Zhang (2010), eq. (13)),
 *
 *     f(t) = a(t) f_i + b(t) f_{i+1} + c(t) e_i + d(t) e_{i+1}
 *
 * where e is 0 (linear), the first derivative (cubic, eq. (14)) or the second (spline, eqs. (17)
 * and (18)). A grid of n points has n s fine points at 0, 1/s, ..., n - 1/s. The last s-1 of them
 * lie beyond the last grid point, in the cell that closes the period. There f is linear between the
 * last and the first point, so that a constant stays constant, the fine grid is as symmetric as the
 * stamp, and interpolation adds no jump to what the DFT sees. */
#pragma once

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>

enum axis_kind { AXIS_NONE, AXIS_LINEAR, AXIS_CUBIC, AXIS_SPLINE };

typedef struct axis_weights {
    double a, b, c, d;
} axis_weights;

/* A fine point: the two ends of its cell (right is 0 in the closing cell) and their weights. */
typedef struct axis_point {
    axis_weights w;
    int left, right;
    bool on_grid; /* it coincides with the grid point `left` */
} axis_point;

typedef struct axis {
    enum axis_kind kind;
    int n;              /* grid points, >= 2 */
    int s;              /* fine points per grid point */
    axis_point *points; /* [n s], then FFT_LANES points with weights 0 */
    double *pivot;      /* [n] elimination factors of the natural spline */
} axis;

/* Place the tables, and fill them unless the arena only counts. */
void axis_place(axis *ax, enum axis_kind kind, int n, int s, arena *a);

/* Fill e for `lanes` lines at once: point i of line l is f[i * stride + l]. No point may be
 * -INFINITY. For a linear axis e is 0. */
void axis_slopes(const axis *ax, const double *f, double *e, size_t stride, int lanes);

/* The same for one line with marks: -INFINITY in `marks` (f itself, or the values that f was made
 * of) stands for a zero pixel under a log method with zeros=skip. Differences are one-sided next to
 * a mark, splines run over the unbroken stretches, and e is 0 at marks. */
void axis_slopes_marked(const axis *ax, const double *marks, const double *f, double *e,
                        size_t stride);

/* Return f at a fine point of such a line; -INFINITY (a mark) in a cell that touches a mark. */
double axis_between_marks(const axis_point *p, double f_left, double f_right, double e_left,
                          double e_right);

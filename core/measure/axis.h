/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/axis.h: interpolation along one axis. All of the paper's methods are separable: bicubic
 * with the paper's mixed derivative is a cubic Hermite interpolation along x, then along y; the 2-D
 * spline is defined that way.
 *
 * On the cell between grid points i and i+1, at t = 0, 1/s, ... (Zhang (2010), eq. (13)),
 *     f(t) = a(t) f_i + b(t) f_{i+1} + c(t) e_i + d(t) e_{i+1}
 * with e = nothing (linear), the first derivative (cubic, eq. (14)) or the second (spline,
 * eqs. (17) and (18)). A grid of n points has n s fine points at 0, 1/s, ..., n - 1/s: the
 * last s-1 of them lie beyond the last grid point, in the cell that closes the period; there f is
 * linear between the last and the first point, so that a constant stays constant, the fine grid is
 * as symmetric as the stamp, and the DFT sees no jump of our making.
 */
#ifndef SHEAR_MEASURE_AXIS_H
#define SHEAR_MEASURE_AXIS_H

#include <stdbool.h>
#include <stddef.h>

enum axis_kind { AXIS_NONE, AXIS_LINEAR, AXIS_CUBIC, AXIS_SPLINE };

typedef struct axis_weights {
    double a, b, c, d;
} axis_weights;

/* A fine point: its cell's ends (right is 0 in the closing cell) and their weights. */
typedef struct axis_point {
    axis_weights w;
    int left, right;
    bool on_grid; /* it is the grid point `left` itself */
} axis_point;

typedef struct axis {
    enum axis_kind kind;
    int n;              /* grid points, >= 2 */
    int s;              /* fine points per grid point */
    axis_point *points; /* [n s], then FFT_LANES whose weights are 0 */
    double *pivot;      /* [n] elimination factors of the natural spline */
} axis;

/* false when memory is out; deinit is safe then too. */
bool axis_init(axis *ax, enum axis_kind kind, int n, int s);
void axis_deinit(axis *ax);

/* e of `lanes` lines at once: point i of lane l is f[i * stride + l]. No point may be -INFINITY.
 * Of a linear axis e is 0. */
void axis_slopes(const axis *ax, const double *f, double *e, size_t stride, int lanes);

/* The same for one line in which -INFINITY in `marks` (f itself, or the values that f was made of)
 * marks a zero pixel under a log method with zeros=skip: differences are one-sided beside a mark,
 * and splines run over the unbroken stretches. e is 0 at marks. */
void axis_slopes_marked(const axis *ax, const double *marks, const double *f, double *e,
                        size_t stride);

/* f at a fine point of such a line: a mark in cells that touch one. */
double axis_between_marks(const axis_point *p, double f_left, double f_right, double e_left,
                          double e_right);

#endif

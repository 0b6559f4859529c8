/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions of data on the canvas. */
#include "internal.h"

#include <math.h>

static const double FAR = 4e6; /* pixels; cairo's fixed-point coordinates end at 8.4e6 */

/* Return 0 at lo, 1 at hi; NaN if there is no position. */
static double part_of(const shear_axis *axis, double v) {
    const shear_range r = axis->range;
    if (axis->log)
        return v > 0.0 && isfinite(v) ? log(v / r.lo) / log(r.hi / r.lo) : NAN;
    return isfinite(v) ? (v - r.lo) / (r.hi - r.lo) : NAN;
}

static double pulled_in(double place) {
    return isnan(place) ? place : fmin(fmax(place, -FAR), FAR);
}

double axes_x(const open_axes *axes, double x) {
    return pulled_in(axes->frame.x + axes->frame.w * part_of(&axes->spec.x, x));
}

double axes_y(const open_axes *axes, double y) {
    return pulled_in(axes->frame.y + axes->frame.h * (1.0 - part_of(&axes->spec.y, y)));
}

bool axes_place(const open_axes *axes, double x, double y, double *px, double *py) {
    *px = axes_x(axes, x);
    *py = axes_y(axes, y);
    return !isnan(*px) && !isnan(*py);
}

bool axes_ready(shear_figure *f) {
    if (!figure_good(f))
        return false;
    if (!f->axes.open)
        figure_failed(f, SHEAR_E_INTERNAL, "drawing without axes: a _begin is missing");
    return f->axes.open;
}

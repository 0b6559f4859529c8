/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reference lines, bands across the frame, bars, ellipses, circles and text on the open axes. */
#include "internal.h"

#include <math.h>

static const double TWO_PI = 6.283185307179586;

void shear_axes_hline(shear_figure *f, double y, const shear_style *style) {
    const shear_range x = f->axes.spec.x.range;
    shear_axes_line(f, 2, (double[]){x.lo, x.hi}, (double[]){y, y}, style);
}

void shear_axes_vline(shear_figure *f, double x, const shear_style *style) {
    const shear_range y = f->axes.spec.y.range;
    shear_axes_line(f, 2, (double[]){x, x}, (double[]){y.hi, y.lo}, style);
}

/* Fill a rectangle on the canvas, at least one pixel wide, without outline. */
static void area(shear_figure *f, double x0, double y0, double x1, double y1,
                 const shear_style *style, double opacity) {
    if (!marks_begin(f))
        return;
    if (!isnan(x0) && !isnan(y0) && !isnan(x1) && !isnan(y1)) {
        const double w = fmax(fabs(x1 - x0), 1.0);
        const double h = fmax(fabs(y1 - y0), 1.0);
        cairo_rectangle(f->cr, (x0 + x1 - w) / 2.0, (y0 + y1 - h) / 2.0, w, h);
        pen_fill(f, style, opacity);
    }
    marks_end(f, SWATCH_BAND, style);
}

void shear_axes_vband(shear_figure *f, double lo, double hi, const shear_style *style) {
    const shear_rect r = f->axes.frame;
    area(f, axes_x(&f->axes, lo), r.y, axes_x(&f->axes, hi), r.y + r.h, style, BAND_OPACITY);
}

void shear_axes_bar(shear_figure *f, bool horizontal, double at, double thick, double from,
                    double to, const shear_style *style) {
    const open_axes *axes = &f->axes;
    const shear_rect r = axes->frame;
    if (horizontal) {
        const double start = axes_x(axes, from);
        area(f, isnan(start) ? r.x : start, axes_y(axes, at - thick / 2.0), axes_x(axes, to),
             axes_y(axes, at + thick / 2.0), style, 1.0);
    } else {
        const double start = axes_y(axes, from);
        area(f, axes_x(axes, at - thick / 2.0), isnan(start) ? r.y + r.h : start,
             axes_x(axes, at + thick / 2.0), axes_y(axes, to), style, 1.0);
    }
}

/* Add the curve (x + a cos t + b sin t, y + c cos t + d sin t), t from 0 to 2 pi. Returns false if
 * a part of it has no position. */
static bool curve_path(shear_figure *f, double x, double y, const double m[4]) {
    enum { STEPS = 180 };
    for (int i = 0; i < STEPS; i++) {
        const double t = TWO_PI * i / STEPS;
        double px, py;
        if (!axes_place(&f->axes, x + m[0] * cos(t) + m[1] * sin(t),
                        y + m[2] * cos(t) + m[3] * sin(t), &px, &py)) {
            cairo_new_path(f->cr);
            return false;
        }
        cairo_line_to(f->cr, px, py);
    }
    cairo_close_path(f->cr);
    return true;
}

static void closed_curve(shear_figure *f, double x, double y, const double m[4], enum swatch swatch,
                         const shear_style *style) {
    if (!marks_begin(f))
        return;
    if (style->fill > 0.0 && curve_path(f, x, y, m))
        pen_fill(f, style, 0.0);
    if (curve_path(f, x, y, m))
        pen_stroke(f, style);
    marks_end(f, swatch, style);
}

void shear_axes_ellipse(shear_figure *f, double x, double y, const double cov[3], double n_sigma,
                        const shear_style *style) {
    const double determinant = cov[0] * cov[2] - cov[1] * cov[1];
    const bool drawn = cov[0] > 0.0 && determinant > 0.0 && isfinite(x) && isfinite(y);
    if (!axes_ready(f) || !drawn)
        return;
    /* The Cholesky factor maps the unit circle to the ellipse. */
    const double l11 = sqrt(cov[0]);
    const double l21 = cov[1] / l11;
    const double l22 = sqrt(determinant) / l11;
    const double m[4] = {n_sigma * l11, 0.0, n_sigma * l21, n_sigma * l22};
    closed_curve(f, x, y, m, style->fill > 0.0 ? SWATCH_AREA : SWATCH_LINE, style);
}

void shear_axes_circle(shear_figure *f, double x, double y, double radius,
                       const shear_style *style) {
    const double m[4] = {radius, 0.0, 0.0, radius};
    closed_curve(f, x, y, m, SWATCH_LINE, style);
}

void shear_axes_text(shear_figure *f, double x, double y, bool inside, const char *text,
                     const shear_text_style *style) {
    if (!axes_ready(f))
        return;
    const shear_rect r = f->axes.frame;
    const double px = inside ? r.x + r.w * x : axes_x(&f->axes, x);
    const double py = inside ? r.y + r.h * (1.0 - y) : axes_y(&f->axes, y);
    if (!isnan(px) && !isnan(py))
        shear_figure_text(f, px, py, text, style);
}

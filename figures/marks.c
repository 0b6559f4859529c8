/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines, points with error bars and histograms on the open axes. */
#include "internal.h"

#include <math.h>

bool marks_begin(shear_figure *f) {
    const shear_rect r = f->axes.frame;
    if (!axes_ready(f))
        return false;
    cairo_save(f->cr);
    cairo_rectangle(f->cr, r.x, r.y, r.w, r.h);
    cairo_clip(f->cr);
    return true;
}

void marks_end(shear_figure *f, enum swatch swatch, const shear_style *style) {
    cairo_restore(f->cr);
    legend_add(f, swatch, style);
}

void shear_axes_line(shear_figure *f, size_t n, const double *x, const double *y,
                     const shear_style *style) {
    if (!marks_begin(f))
        return;
    bool pen_down = false;
    for (size_t i = 0; i < n; i++) {
        double px, py;
        if (!axes_place(&f->axes, x[i], y[i], &px, &py)) {
            pen_down = false;
        } else if (pen_down) {
            cairo_line_to(f->cr, px, py);
        } else {
            cairo_move_to(f->cr, px, py);
            pen_down = true;
        }
    }
    pen_stroke(f, style);
    marks_end(f, SWATCH_LINE, style);
}

/* Draw an error bar from (x0, y0) to (x1, y1) on the canvas. */
static void error_bar(shear_figure *f, double x0, double y0, double x1, double y1) {
    if (!isnan(x0) && !isnan(y0) && !isnan(x1) && !isnan(y1)) {
        cairo_move_to(f->cr, x0, y0);
        cairo_line_to(f->cr, x1, y1);
    }
}

/* Return the lower end of a bar; on a log axis it may have no position, and is then the frame. */
static double lower_end(const open_axes *axes, double (*map)(const open_axes *, double),
                        double value, double at_frame) {
    const double place = map(axes, value);
    return isnan(place) && isfinite(value) ? at_frame : place;
}

static void error_bars(shear_figure *f, double x, double y, double x_err, double y_err) {
    const open_axes *axes = &f->axes;
    const shear_rect r = axes->frame;
    const double px = axes_x(axes, x);
    const double py = axes_y(axes, y);
    if (x_err > 0.0)
        error_bar(f, lower_end(axes, axes_x, x - x_err, r.x), py, axes_x(axes, x + x_err), py);
    if (y_err > 0.0) {
        error_bar(f, px, lower_end(axes, axes_y, y - y_err, r.y + r.h), px,
                  axes_y(axes, y + y_err));
    }
}

void shear_axes_points(shear_figure *f, size_t n, const double *x, const double *y,
                       const double *x_err, const double *y_err, const shear_style *style) {
    if (!marks_begin(f))
        return;
    for (size_t i = 0; i < n; i++)
        error_bars(f, x[i], y[i], x_err != NULL ? x_err[i] : 0.0, y_err != NULL ? y_err[i] : 0.0);
    shear_style bars = *style;
    bars.dash = SHEAR_SOLID;
    pen_stroke(f, &bars);
    for (size_t i = 0; i < n; i++) {
        double px, py;
        if (axes_place(&f->axes, x[i], y[i], &px, &py))
            pen_marker(f, px, py, style);
    }
    marks_end(f, SWATCH_POINT, style);
}

/* Add the steps of the histogram, from the base line and back to it. */
static void steps_path(shear_figure *f, int bins, shear_range r, const double *counts) {
    const open_axes *axes = &f->axes;
    const double base = axes->frame.y + axes->frame.h;
    const double width = (r.hi - r.lo) / bins;
    cairo_move_to(f->cr, axes_x(axes, r.lo), base);
    for (int b = 0; b < bins; b++) {
        const double top = axes_y(axes, counts[b]);
        const double y = isnan(top) ? base : top; /* zero counts on a log axis */
        cairo_line_to(f->cr, axes_x(axes, r.lo + width * b), y);
        cairo_line_to(f->cr, axes_x(axes, r.lo + width * (b + 1)), y);
    }
    cairo_line_to(f->cr, axes_x(axes, r.hi), base);
}

void shear_axes_histogram(shear_figure *f, int bins, shear_range r, const double *counts,
                          const shear_style *style) {
    if (!axes_ready(f))
        return;
    const bool placed = !isnan(axes_x(&f->axes, r.lo)) && !isnan(axes_x(&f->axes, r.hi));
    if (bins < 1 || !placed)
        figure_failed(f, SHEAR_E_INTERNAL, "a histogram without bins, or off the axis");
    if (!marks_begin(f))
        return;
    if (style->fill > 0.0) {
        steps_path(f, bins, r, counts);
        pen_fill(f, style, 0.0);
    }
    steps_path(f, bins, r, counts);
    pen_stroke(f, style);
    marks_end(f, style->fill > 0.0 ? SWATCH_AREA : SWATCH_LINE, style);
}

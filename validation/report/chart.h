/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart.h: panels of shear against something, as most of the paper's figures are. */
#ifndef VALIDATION_CHART_H
#define VALIDATION_CHART_H

#include "shear_figures/figure.h"

enum { CHART_MAX_POINTS = 64 };

/* Points with error bars: one method, say; or a line through them. */
typedef struct curve {
    const char *label; /* or NULL */
    enum shear_hue hue;
    enum shear_marker marker;
    bool line;            /* no markers and bars */
    enum shear_dash dash; /* of a line */
    int n;
    double x[CHART_MAX_POINTS], y[CHART_MAX_POINTS], err[CHART_MAX_POINTS];
} curve;
/* Append a point; what does not fit is dropped. */
void curve_add(curve *c, double x, double y, double err);

typedef struct chart {
    const char *title, *x_label, *y_label; /* or NULL */
    bool log_x, log_y;
    enum shear_corner legend; /* where curves have labels */
    double truth;             /* a dotted line; NaN = none */
    double limit;             /* a dashed upright one; 0 = none */
    shear_range y;            /* lo == hi: by the points and their error bars */
    double headroom;          /* above the points for the legend, as a part of the y axis */
    double spread;            /* shift curve i by (i - middle) times this part of the x axis */
    int n_curves;
    const curve *curves;
} chart;
/* Draw the whole panel. */
void chart_draw(shear_figure *f, shear_rect cell, const chart *c);

#endif

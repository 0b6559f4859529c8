/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart.h: panels of the shear against another quantity, as in most figures of the paper. */
#pragma once

#include "shear_figures/figure.h"

enum { CHART_MAX_POINTS = 64 };

/* Points with error bars (for example, of one method), or a line through them. */
typedef struct curve {
    const char *label; /* NULL: none */
    enum shear_hue hue;
    enum shear_marker marker;
    bool line;            /* without markers and error bars */
    enum shear_dash dash; /* of a line */
    int n;
    double x[CHART_MAX_POINTS], y[CHART_MAX_POINTS], err[CHART_MAX_POINTS];
} curve;
/* Append a point; points beyond the capacity are dropped. */
void curve_add(curve *c, double x, double y, double err);

typedef struct chart {
    const char *title, *x_label, *y_label; /* NULL: none */
    bool log_x, log_y;
    enum shear_corner legend; /* if curves have labels */
    double truth;             /* a dotted line; NaN: none */
    double limit;             /* a dashed vertical line; 0: none */
    shear_range y;            /* lo == hi: from the points and their error bars */
    double headroom; /* space above the points for the legend, as a fraction of the y axis */
    double spread;   /* shift curve i by (i - middle) times this fraction of the x axis */
    int n_curves;
    const curve *curves;
} chart;
/* Draw the whole panel. */
void chart_draw(shear_figure *f, shear_rect cell, const chart *c);

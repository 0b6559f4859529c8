/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart.h: panels of shear against something, as most of the paper's figures are. */
#ifndef VALIDATION_CHART_H
#define VALIDATION_CHART_H

#include "shear_figures/figure.h"

enum { CHART_MAX_POINTS = 64 };

/* Points with error bars: one method, say; or a line through them. */
struct curve {
    const char *label; /* or NULL */
    int hue;           /* enum shear_hue */
    int marker;        /* enum shear_marker */
    bool line;         /* no markers and bars */
    int dash;          /* enum shear_dash, of a line */
    int n;
    double x[CHART_MAX_POINTS], y[CHART_MAX_POINTS], err[CHART_MAX_POINTS];
};
/* Append a point; what does not fit is dropped. */
void curve_add(struct curve *c, double x, double y, double err);

struct chart {
    shear_rect cell;
    const char *title, *x_label, *y_label; /* or NULL */
    bool log_x, log_y, bare_x;
    int legend;       /* enum shear_corner; where curves have labels */
    double truth;     /* a dotted line; NaN = none */
    double limit;     /* a dashed upright one; 0 = none */
    shear_range x, y; /* lo == hi: by the points */
    double headroom;  /* room above the points for the legend, as a part of the y axis */
    double spread;    /* shift the i-th curve by (i - middle) times this part of the x axis */
    int n_curves;
    const struct curve *curves;
};
/* `with_bars`: error bars widen the range chosen for y. Draws the whole panel. */
void chart_draw(shear_figure *f, const struct chart *chart);

#endif

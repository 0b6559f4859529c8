/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/chart.h"

#include <math.h>

void curve_add(struct curve *c, double x, double y, double err) {
    if (c->n < CHART_MAX_POINTS) {
        c->x[c->n] = x;
        c->y[c->n] = y;
        c->err[c->n++] = err;
    }
}

static shear_range range_of_x(const struct chart *chart) {
    shear_range r = {NAN, NAN};
    for (int i = 0; i < chart->n_curves; i++) {
        r = shear_range_join(r, shear_range_of(chart->curves[i].x, (size_t)chart->curves[i].n));
    }
    if (!chart->log_x) {
        return shear_range_pad(r, 0.06);
    }
    double factor = pow(r.hi / r.lo, 0.06);
    return (shear_range){r.lo / factor, r.hi * factor};
}

/* Of the values that have a logarithm. */
static shear_range range_of_log_y(const struct chart *chart) {
    shear_range r = {NAN, NAN};
    for (int i = 0; i < chart->n_curves; i++) {
        const struct curve *c = &chart->curves[i];
        for (int k = 0; k < c->n; k++) {
            const double y = c->y[k] > 0.0 ? c->y[k] : NAN;
            r = shear_range_join(r, (shear_range){y, y});
        }
    }
    const double factor = pow(r.hi / r.lo, 0.08);
    return (shear_range){r.lo / factor, r.hi * factor * pow(r.hi / r.lo, chart->headroom)};
}

static shear_range range_of_y(const struct chart *chart) {
    if (chart->log_y) {
        return range_of_log_y(chart);
    }
    shear_range r = {chart->truth, chart->truth};
    for (int i = 0; i < chart->n_curves; i++) {
        const struct curve *c = &chart->curves[i];
        for (int k = 0; k < c->n; k++) {
            double err = isfinite(c->err[k]) ? c->err[k] : 0.0;
            r = shear_range_join(r, (shear_range){c->y[k] - err, c->y[k] + err});
        }
    }
    r = shear_range_pad(r, 0.08);
    r.hi += chart->headroom * (r.hi - r.lo);
    return r;
}

/* Curves side by side, so that error bars do not hide each other. */
static void draw_curve(shear_figure *f, const struct chart *chart, int i, shear_range x) {
    const struct curve *c = &chart->curves[i];
    double shift = (i - 0.5 * (chart->n_curves - 1)) * chart->spread;
    double at[CHART_MAX_POINTS];
    for (int k = 0; k < c->n; k++) {
        at[k] = chart->log_x ? c->x[k] * pow(x.hi / x.lo, shift) : c->x[k] + shift * (x.hi - x.lo);
    }
    const shear_style style = {.colour = shear_palette(c->hue),
                               .marker = c->marker,
                               .dash = c->dash,
                               .size = 5.0,
                               .label = c->label};
    if (c->line) {
        shear_axes_line(f, (size_t)c->n, c->x, c->y, &style);
    } else {
        shear_axes_points(f, (size_t)c->n, at, c->y, NULL, c->err, &style);
    }
}

void chart_draw(shear_figure *f, const struct chart *chart) {
    shear_range x = chart->x.lo < chart->x.hi ? chart->x : range_of_x(chart);
    shear_range y = chart->y.lo < chart->y.hi ? chart->y : range_of_y(chart);
    const shear_axes axes = {
        .cell = chart->cell,
        .title = chart->title,
        .x = {.range = x, .log = chart->log_x, .label = chart->x_label, .bare = chart->bare_x},
        .y = {.range = y, .log = chart->log_y, .label = chart->y_label},
        .legend = chart->legend};
    shear_axes_begin(f, &axes);
    if (isfinite(chart->truth)) {
        shear_axes_hline(f, chart->truth, &(shear_style){.dash = SHEAR_DOTTED, .width = 1.2});
    }
    if (chart->limit > 0.0) {
        shear_axes_vline(f, chart->limit, &(shear_style){.dash = SHEAR_DASHED, .width = 1.2});
    }
    for (int i = 0; i < chart->n_curves; i++) {
        draw_curve(f, chart, i, x);
    }
    shear_axes_end(f);
}

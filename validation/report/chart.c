/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/chart.h"

#include <math.h>

void curve_add(curve *c, double x, double y, double err) {
    if (c->n < CHART_MAX_POINTS) {
        c->x[c->n] = x;
        c->y[c->n] = y;
        c->err[c->n++] = err;
    }
}

static shear_range range_of_x(const chart *c) {
    shear_range r = {NAN, NAN};
    for (int i = 0; i < c->n_curves; i++)
        r = shear_range_join(r, shear_range_of(c->curves[i].x, (size_t)c->curves[i].n));
    if (!c->log_x)
        return shear_range_pad(r, 0.06);
    const double factor = pow(r.hi / r.lo, 0.06);
    return (shear_range){r.lo / factor, r.hi * factor};
}

static shear_range range_of_y(const chart *c) {
    shear_range r = {c->truth, c->truth};
    if (c->y.lo < c->y.hi)
        return c->y;
    for (int i = 0; i < c->n_curves; i++) {
        const curve *of = &c->curves[i];
        for (int k = 0; k < of->n; k++) {
            const double err = isfinite(of->err[k]) ? of->err[k] : 0.0;
            r = shear_range_join(r, (shear_range){of->y[k] - err, of->y[k] + err});
        }
    }
    r = shear_range_pad(r, 0.08);
    r.hi += c->headroom * (r.hi - r.lo);
    return r;
}

/* Draw a curve, shifted so that error bars do not cover each other. */
static void draw_curve(shear_figure *f, const chart *chart_of, int i, shear_range x) {
    const curve *c = &chart_of->curves[i];
    const double shift = (i - 0.5 * (chart_of->n_curves - 1)) * chart_of->spread;
    const shear_style style = {.colour = shear_palette((int)c->hue),
                               .marker = c->marker,
                               .dash = c->dash,
                               .size = 5.0,
                               .label = c->label};
    double at[CHART_MAX_POINTS];
    if (c->line) {
        shear_axes_line(f, (size_t)c->n, c->x, c->y, &style);
        return;
    }
    for (int k = 0; k < c->n; k++) {
        at[k] =
            chart_of->log_x ? c->x[k] * pow(x.hi / x.lo, shift) : c->x[k] + shift * (x.hi - x.lo);
    }
    shear_axes_points(f, (size_t)c->n, at, c->y, NULL, c->err, &style);
}

void chart_draw(shear_figure *f, shear_rect cell, const chart *c) {
    const shear_range x = range_of_x(c);
    shear_axes_begin(f, &(shear_axes){.cell = cell,
                                      .title = c->title,
                                      .x = {.range = x, .log = c->log_x, .label = c->x_label},
                                      .y = {range_of_y(c), .log = c->log_y, .label = c->y_label},
                                      .legend = c->legend});
    if (isfinite(c->truth))
        shear_axes_hline(f, c->truth, &(shear_style){.dash = SHEAR_DOTTED, .width = 1.2});
    if (c->limit > 0.0)
        shear_axes_vline(f, c->limit, &(shear_style){.dash = SHEAR_DASHED, .width = 1.2});
    for (int i = 0; i < c->n_curves; i++)
        draw_curve(f, c, i, x);
    shear_axes_end(f);
}

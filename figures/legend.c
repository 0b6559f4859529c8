/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The legend: its entries are collected with the marks, and drawn in a corner at the end. */
#include "internal.h"

#include <math.h>
#include <string.h>

static const double ROW = 17.0;
static const double SWATCH = 22.0;
static const double PAD = 8.0;

void legend_add(shear_figure *f, enum swatch swatch, const shear_style *style) {
    open_axes *axes = &f->axes;
    if (style->label == NULL || axes->n_legend == MAX_LEGEND)
        return;
    legend_entry *entry = &axes->legend[axes->n_legend++];
    *entry = (legend_entry){.swatch = swatch, .style = *style};
    memcpy(entry->label, style->label, label_cut(style->label, sizeof entry->label - 1));
}

static void draw_swatch(shear_figure *f, const legend_entry *entry, double x, double y) {
    if (entry->swatch == SWATCH_POINT) {
        pen_marker(f, x + SWATCH / 2.0, y, &entry->style);
        return;
    }
    if (entry->swatch == SWATCH_LINE) {
        cairo_move_to(f->cr, x, y);
        cairo_line_to(f->cr, x + SWATCH, y);
        pen_stroke(f, &entry->style);
        return;
    }
    cairo_rectangle(f->cr, x + 1.0, y - 5.0, SWATCH - 2.0, 10.0);
    pen_fill(f, &entry->style, BAND_OPACITY);
    if (entry->swatch == SWATCH_AREA) {
        cairo_rectangle(f->cr, x + 1.0, y - 5.0, SWATCH - 2.0, 10.0);
        pen_stroke(f, &entry->style);
    }
}

void legend_draw(shear_figure *f) {
    const open_axes *axes = &f->axes;
    const shear_rect r = axes->frame;
    double widest = 0.0;
    if (axes->n_legend == 0)
        return;
    for (int i = 0; i < axes->n_legend; i++)
        widest = fmax(widest, shear_figure_text_width(f, axes->legend[i].label, TICK_SIZE + 0.5));
    const double w = SWATCH + 6.0 + widest + 2.0 * PAD;
    const double h = ROW * axes->n_legend + PAD;
    const enum shear_corner corner = axes->spec.legend;
    const bool left = corner == SHEAR_TOP_LEFT || corner == SHEAR_BOTTOM_LEFT;
    const bool top = corner == SHEAR_TOP_LEFT || corner == SHEAR_TOP_RIGHT;
    const double x = left ? r.x + 5.0 : r.x + r.w - w - 5.0;
    const double y = top ? r.y + 5.0 : r.y + r.h - h - 5.0;
    cairo_set_source_rgba(f->cr, 1.0, 1.0, 1.0, 0.8);
    cairo_rectangle(f->cr, x, y, w, h);
    cairo_fill(f->cr);
    for (int i = 0; i < axes->n_legend; i++) {
        const double middle = y + PAD / 2.0 + ROW * (i + 0.5);
        draw_swatch(f, &axes->legend[i], x + PAD, middle);
        shear_figure_text(f, x + PAD + SWATCH + 6.0, middle, axes->legend[i].label,
                          &(shear_text_style){.size = TICK_SIZE + 0.5});
    }
}

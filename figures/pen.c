/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes, fills and markers. */
#include "internal.h"

static const double LINE_WIDTH = 1.4;
static const double MARKER_SIZE = 6.0;

void pen_stroke(shear_figure *f, const shear_style *style) {
    static const double dashed[2] = {6.0, 3.5};
    static const double dotted[2] = {1.5, 2.8};
    figure_set_colour(f, style->colour);
    cairo_set_line_width(f->cr, style->width > 0.0 ? style->width : LINE_WIDTH);
    if (style->dash == SHEAR_SOLID) {
        cairo_set_dash(f->cr, NULL, 0, 0.0);
    } else {
        cairo_set_dash(f->cr, style->dash == SHEAR_DASHED ? dashed : dotted, 2, 0.0);
    }
    cairo_stroke(f->cr);
    cairo_set_dash(f->cr, NULL, 0, 0.0);
}

void pen_fill(shear_figure *f, const shear_style *style, double default_opacity) {
    shear_colour colour = style->colour.a > 0.0 ? style->colour : shear_palette(SHEAR_BLACK);
    colour.a *= style->fill > 0.0 ? style->fill : default_opacity;
    if (colour.a > 0.0) {
        figure_set_colour(f, colour);
        cairo_fill(f->cr);
    }
    cairo_new_path(f->cr);
}

static void triangle(cairo_t *cr, double x, double y, double r) {
    cairo_move_to(cr, x, y - 1.15 * r);
    cairo_line_to(cr, x + r, y + 0.75 * r);
    cairo_line_to(cr, x - r, y + 0.75 * r);
    cairo_close_path(cr);
}

static void marker_path(cairo_t *cr, double x, double y, double r, enum shear_marker marker) {
    switch (marker) {
    case SHEAR_SQUARE:
        cairo_rectangle(cr, x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
        break;
    case SHEAR_TRIANGLE:
        triangle(cr, x, y, r);
        break;
    case SHEAR_CROSS:
        cairo_move_to(cr, x - r, y - r);
        cairo_line_to(cr, x + r, y + r);
        cairo_move_to(cr, x - r, y + r);
        cairo_line_to(cr, x + r, y - r);
        break;
    case SHEAR_PLUS:
        cairo_move_to(cr, x - r, y);
        cairo_line_to(cr, x + r, y);
        cairo_move_to(cr, x, y - r);
        cairo_line_to(cr, x, y + r);
        break;
    default:
        cairo_arc(cr, x, y, r, 0.0, 6.283185307179586);
        break;
    }
}

void pen_marker(shear_figure *f, double x, double y, const shear_style *style) {
    const double radius = (style->size > 0.0 ? style->size : MARKER_SIZE) / 2.0;
    const enum shear_marker marker = style->marker;
    cairo_new_path(f->cr);
    marker_path(f->cr, x, y, radius, marker);
    if (marker == SHEAR_CIRCLE || marker == SHEAR_CROSS || marker == SHEAR_PLUS) {
        shear_style outline = *style;
        outline.dash = SHEAR_SOLID;
        pen_stroke(f, &outline);
    } else {
        figure_set_colour(f, style->colour);
        cairo_fill(f->cr);
    }
}

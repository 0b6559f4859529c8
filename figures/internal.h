/* SPDX-License-Identifier: GPL-3.0-or-later */
/* internal.h: the figure's struct and the functions that only this room uses. */
#pragma once

#include "shear_figures/figure.h"

#include <cairo.h>

enum { MAX_LEGEND = 16, LEGEND_LABEL = 96 };

/* The kind of a legend's sample. */
enum swatch { SWATCH_LINE, SWATCH_POINT, SWATCH_AREA, SWATCH_BAND /* without outline */ };

typedef struct legend_entry {
    enum swatch swatch;
    shear_style style;
    char label[LEGEND_LABEL];
} legend_entry;

/* The axes between _begin and _end. */
typedef struct open_axes {
    bool open;
    bool image; /* over an image: ticks point outward, so that they hide no pixels */
    bool ticks;
    shear_axes spec; /* ranges as drawn: finite, lo < hi */
    shear_rect frame;
    shear_ticks x_ticks, y_ticks;
    int n_legend;
    legend_entry legend[MAX_LEGEND];
} open_axes;

struct shear_figure {
    cairo_surface_t *surface;
    cairo_t *cr;
    int width, height;
    shear_error error; /* the first failure; code SHEAR_OK: none */
    open_axes axes;
};

static const double LABEL_SIZE = 12.0;
static const double TICK_SIZE = 10.5;
static const double TITLE_SIZE = 12.5;
static const double TITLE_ROOM = 25.0;
static const double LABEL_ROOM = 20.0;
static const double FRAME_WIDTH = 0.9;
static const double BAND_OPACITY = 0.2;

/* canvas.c: return whether nothing has failed; below, keep a failure. */
bool figure_good(shear_figure *f);
void figure_failed(shear_figure *f, int code, const char *message);
void figure_set_colour(shear_figure *f, shear_colour colour);

/* label.c: return the number of bytes of `text`, at most `most`, that are complete UTF-8
 * characters. */
size_t label_cut(const char *text, size_t most);

/* place.c: convert data to canvas coordinates; NaN if there is no position (not finite, not
 * positive on a log axis). Distant positions are limited to the range of cairo's fixed-point
 * numbers. */
double axes_x(const open_axes *axes, double x);
double axes_y(const open_axes *axes, double y);
/* Convert both. Returns whether there is a position. */
bool axes_place(const open_axes *axes, double x, double y, double *px, double *py);
/* Return whether axes are open and nothing has failed; otherwise keep the failure. */
bool axes_ready(shear_figure *f);

/* pen.c: stroke and fill the path with the style's colour, width and dash; draw a marker. */
void pen_stroke(shear_figure *f, const shear_style *style);
void pen_fill(shear_figure *f, const shear_style *style, double default_opacity);
void pen_marker(shear_figure *f, double x, double y, const shear_style *style);

/* legend.c: add an entry to the legend. */
void legend_add(shear_figure *f, enum swatch swatch, const shear_style *style);
void legend_draw(shear_figure *f);

/* marks.c: clip at the frame; false if axes are not ready. End the clipping, and add an entry to
 * the legend. */
bool marks_begin(shear_figure *f);
void marks_end(shear_figure *f, enum swatch swatch, const shear_style *style);

/* axes.c: return the largest centred part of r with the proportions `wide` to `high`. */
shear_rect axes_fit(shear_rect r, double wide, double high);
/* axes.c: make `spec` the open axes with the given frame. */
void axes_open(shear_figure *f, const shear_axes *spec, shear_rect frame);
/* Draw ticks along y at x = edge, to the right, for colour bars. */
void axes_draw_bar_ticks(shear_figure *f, shear_rect bar, const shear_stretch *stretch,
                         const shear_ticks *ticks);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_figures/figure.h: figures with axes and images, drawn from numbers and written as PNG.
 *
 * A figure is a white canvas in pixels, with the origin at the top left. shear_grid_cell divides it
 * into cells, for an image or axes each. A _begin function opens the cell, drawing functions use
 * data coordinates, and shear_axes_end draws frame, ticks, labels and legend on top.
 *
 * Drawing functions return nothing. The first failure (out of memory, an array without pixels) is
 * kept: nothing more is drawn, and shear_figure_save returns the failure. Strings and arrays are
 * only used during the call, except those of a _begin function, which must live until
 * shear_axes_end. A figure may be used by one thread at a time; several figures may be drawn in
 * parallel.
 *
 * Text is UTF-8; "_{...}" and "^{...}" are sub- and superscripts ("R_{PSF}"). */
#ifndef SHEAR_FIGURES_FIGURE_H
#define SHEAR_FIGURES_FIGURE_H

#include "shear/error.h"
#include "shear_figures/scale.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct shear_figure shear_figure;

/* Create a white canvas of 1 to 20000 pixels per side. Returns SHEAR_OK, SHEAR_E_NOMEM or
 * SHEAR_E_SETTING. */
int shear_figure_new(shear_figure **figure, int width, int height, shear_error *err);
void shear_figure_free(shear_figure *figure);

/* Return the colour at pixel (x, y) from the top left, 0xRRGGBB; white outside the canvas. */
uint32_t shear_figure_pixel(shear_figure *figure, int x, int y);

/* Write a PNG to a temporary file beside `path`, then rename it, so that no incomplete file is ever
 * visible. Returns the first failure of a drawing function; SHEAR_E_EXISTS if the file exists and
 * `replace` is false; SHEAR_E_IO. */
int shear_figure_save(shear_figure *figure, const char *path, bool replace, shear_error *err);

/* ---- layout ---- */

typedef struct shear_rect {
    double x, y, w, h; /* top left corner, width and height, pixels */
} shear_rect;

typedef struct shear_grid {
    shear_rect area;
    int rows, columns;
    double gap_x, gap_y;          /* between cells, pixels */
    const double *row_weights;    /* [rows] relative heights; NULL: equal */
    const double *column_weights; /* [columns] relative widths; NULL: equal */
} shear_grid;

/* Return the cell that starts at (row, column), row 0 at the top, and spans the given numbers of
 * rows and columns. Cells outside the grid are empty. */
shear_rect shear_grid_cell(const shear_grid *grid, int row, int column, int row_span,
                           int column_span);

/* ---- text on the canvas ---- */

typedef struct shear_text_style {
    double size; /* pixels; 0: 12 */
    bool bold;
    double align;        /* 0: x is the left end, 0.5: the middle, 1: the right end */
    bool upward;         /* rotated by 90 degrees, reading upward */
    shear_colour colour; /* opacity 0: black */
} shear_text_style;

/* Draw text; y is the middle of the capital letters. */
void shear_figure_text(shear_figure *figure, double x, double y, const char *text,
                       const shear_text_style *style);
/* Return the width of `text` in pixels. */
double shear_figure_text_width(shear_figure *figure, const char *text, double size);
/* Draw two columns of text under a title: keys[n], values[n]. An empty key continues the line
 * above. */
void shear_figure_table(shear_figure *figure, shear_rect cell, const char *title, int n,
                        const char *const *keys, const char *const *values);

/* ---- axes ---- */

enum shear_corner { SHEAR_TOP_RIGHT = 0, SHEAR_TOP_LEFT, SHEAR_BOTTOM_LEFT, SHEAR_BOTTOM_RIGHT };

typedef struct shear_axis {
    shear_range range; /* finite with lo < hi (and lo > 0 if log); otherwise it is widened until it
                          can be drawn */
    bool log;
    const char *label;        /* NULL: none */
    bool bare;                /* without tick labels */
    int n_names;              /* names at 0, 1, 2, ... instead of numbers; no ticks */
    const char *const *names; /* [n_names] */
} shear_axis;

typedef struct shear_axes {
    shear_rect cell;   /* including labels and title */
    const char *title; /* NULL: none */
    shear_axis x, y;
    bool equal;               /* same scale in x and y: the frame is reduced accordingly */
    enum shear_corner legend; /* drawn if any style has a label */
    double left;              /* space left of the frame, pixels; 0: as the labels need */
} shear_axes;

/* Open axes in a cell; draw their frame, ticks, labels and legend, and close them. */
void shear_axes_begin(shear_figure *figure, const shear_axes *axes);
void shear_axes_end(shear_figure *figure);
/* Return the frame's rectangle on the canvas, between _begin and _end. */
shear_rect shear_axes_frame(const shear_figure *figure);

enum shear_dash { SHEAR_SOLID = 0, SHEAR_DASHED, SHEAR_DOTTED };
enum shear_marker {
    SHEAR_DISC = 0,
    SHEAR_CIRCLE,
    SHEAR_SQUARE,
    SHEAR_TRIANGLE,
    SHEAR_CROSS,
    SHEAR_PLUS
};

typedef struct shear_style {
    shear_colour colour; /* opacity 0: black */
    double width;        /* of lines, pixels; 0: 1.4 */
    enum shear_dash dash;
    enum shear_marker marker; /* for points */
    double size;              /* of markers, pixels across; 0: 6 */
    double fill;              /* opacity of the filled area, 0: not filled; for bands 0: 0.2 */
    const char *label;        /* in the legend, at most 95 bytes; NULL: none */
} shear_style;

/* Draw a line. Values that are not finite (or not positive on a log axis) leave gaps. */
void shear_axes_line(shear_figure *f, size_t n, const double *x, const double *y,
                     const shear_style *style);
/* Draw points. x_err, y_err: half lengths of the error bars [n], or NULL. */
void shear_axes_points(shear_figure *f, size_t n, const double *x, const double *y,
                       const double *x_err, const double *y_err, const shear_style *style);
/* Draw lines across the whole frame. */
void shear_axes_hline(shear_figure *f, double y, const shear_style *style);
void shear_axes_vline(shear_figure *f, double x, const shear_style *style);
/* Fill the area between two values of x across the whole frame; at least one pixel wide. */
void shear_axes_vband(shear_figure *f, double lo, double hi, const shear_style *style);
/* Draw counts[bins] in equal bins of r, as steps; filled with style.fill. */
void shear_axes_histogram(shear_figure *f, int bins, shear_range r, const double *counts,
                          const shear_style *style);
/* Draw a bar from `from` to `to` along x (horizontal) around y = at, or along y around x = at;
 * `thick` is in data units. */
void shear_axes_bar(shear_figure *f, bool horizontal, double at, double thick, double from,
                    double to, const shear_style *style);
/* Draw the n_sigma ellipse around (x, y) of the covariance {c11, c12, c22}; nothing if that is not
 * positive definite. */
void shear_axes_ellipse(shear_figure *f, double x, double y, const double cov[3], double n_sigma,
                        const shear_style *style);
/* Draw a circle whose radius is in data units of x (a circle on the canvas if axes are equal). */
void shear_axes_circle(shear_figure *f, double x, double y, double radius,
                       const shear_style *style);
/* Draw text at data coordinates or, if `inside`, at fractions of the frame's width and height from
 * its lower left corner. */
void shear_axes_text(shear_figure *f, double x, double y, bool inside, const char *text,
                     const shear_text_style *style);

/* ---- images ---- */

typedef struct shear_image {
    shear_rect cell;
    const char *title;    /* NULL: none */
    const double *pixels; /* [ny][nx], row 0 at the bottom */
    int nx, ny;           /* 1 to 32767 */
    enum shear_stretch_kind stretch;
    shear_range limits;      /* the displayed values; lo == hi: given by the percentiles below */
    shear_range percentiles; /* of the finite pixels; lo == hi: 0.5 and 99.8 */
    double knee;             /* of SHEAR_ASINH; 0: automatic */
    enum shear_map map;
    bool mark_negative;      /* show negative pixels in the blue of shear_map_negative */
    shear_colour not_finite; /* opacity 0: the pink of shear_map_not_finite */
    bool colour_bar;
    double bar_room;  /* pixels for the colour bar's labels; 0: 44 */
    shear_range x, y; /* coordinates of the outer edges; lo == hi: -0.5 to nx - 0.5 */
    bool equal;       /* x and y have the same unit of length; otherwise pixels are square */
    bool ticks;       /* draw ticks and labels */
    const char *x_label, *y_label; /* NULL: none; with ticks */
} shear_image;

/* Draw an image without smoothing. If its pixels are smaller than those of the figure, they are
 * averaged. Overlays may be drawn as on axes, until shear_axes_end. */
void shear_image_begin(shear_figure *figure, const shear_image *image);

#endif

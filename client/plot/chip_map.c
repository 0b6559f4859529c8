/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/chip_map.h"

#include "base/cleanup.h"
#include "plot/text.h"

#include <math.h>
#include <stdlib.h>

/* Exceptions come before what they are a part of. */
const chip_kind chip_kinds[CHIP_KINDS] = {{"measured", 0, SHEAR_BLUE},
                                          {"saturated", SHEAR_FLAG_SATURATED, SHEAR_PURPLE},
                                          {"hole", SHEAR_FLAG_HOLE, SHEAR_VERMILION},
                                          {"neighbour", SHEAR_FLAG_NEIGHBOUR, SHEAR_ORANGE},
                                          {"edge", SHEAR_FLAG_EDGE, SHEAR_GREY},
                                          {"no noise", SHEAR_FLAG_NO_NOISE, SHEAR_GREEN},
                                          {"no position", SHEAR_FLAG_NO_POSITION, SHEAR_BLACK},
                                          {"others", ~0u, SHEAR_SKY}};

int chip_kind_of(const chip_galaxy *g) {
    int kind = g->flags == 0 ? 0 : 1;
    while (g->flags != 0 && (g->flags & chip_kinds[kind].flags) == 0)
        kind++;
    return kind;
}

/* ---- the image ---- */

/* Turn the picture over: the sky becomes 0, and what is bright negative, so that it is dark on
 * white. Sets the range of what is shown, and its knee. */
static int turn_over(double *pixels, const chip_survey *s, shear_range *limits, double *knee,
                     shear_error *err) {
    const size_t n = (size_t)s->nx * (size_t)s->ny;
    shear_range middle;
    shear_range outer;
    TRY(shear_range_percentile(&middle, s->pixels, n, 25.0, 50.0, err));
    TRY(shear_range_percentile(&outer, s->pixels, n, 0.5, 99.7, err));
    const double sigma = (middle.hi - middle.lo) / 0.6745;
    for (size_t i = 0; i < n; i++)
        pixels[i] = middle.hi - s->pixels[i];
    *knee = 6.0 * sigma;
    *limits = (shear_range){middle.hi - fmax(outer.hi, middle.hi + 12.0 * sigma), 0.8 * sigma};
    return SHEAR_OK;
}

static shear_style line_of(int hue, double opacity, double width) {
    return (shear_style){.colour = shear_palette_faint(hue, opacity), .width = width};
}

static void draw_box(shear_figure *f, int x, int y, int side, const shear_style *style) {
    const double left = x + 0.5; /* the first pixel's edge, where it counts from 1 */
    const double low = y + 0.5;
    const double xs[] = {left, left + side, left + side, left, left};
    const double ys[] = {low, low, low + side, low + side, low};
    shear_axes_line(f, 5, xs, ys, style);
}

static void draw_noise_boxes(shear_figure *f, const chip_survey *s, int stamp) {
    const shear_style style = line_of(SHEAR_GREEN, 0.45, 0.7);
    for (int64_t i = 0; i < s->chip.n_stamps; i++) {
        const shear_chip_place *p = &s->galaxies[i].place;
        for (int k = 0; k < p->n_noise && s->galaxies[i].flags == 0; k++)
            draw_box(f, p->noise_x[k], p->noise_y[k], stamp, &style);
    }
}

static int draw_galaxies(shear_figure *f, const chip_survey *s, shear_error *err) {
    const size_t n = (size_t)s->chip.n_stamps;
    CLEANUP(release_free) double *x = calloc(2 * n + 1, sizeof *x);
    if (x == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a picture");
    for (int kind = CHIP_KINDS - 1; kind >= 0; kind--) {
        size_t k = 0;
        for (size_t i = 0; i < n; i++) {
            if (chip_kind_of(&s->galaxies[i]) == kind) {
                x[k] = s->galaxies[i].place.x;
                x[n + k++] = s->galaxies[i].place.y;
            }
        }
        const shear_style style = {.colour = shear_palette(chip_kinds[kind].hue),
                                   .marker = SHEAR_CIRCLE,
                                   .size = 11.0,
                                   .width = 1.5};
        shear_axes_points(f, k, x, x + n, NULL, NULL, &style);
    }
    return SHEAR_OK;
}

int chip_map_draw(shear_figure *f, shear_rect cell, const chip_survey *s, int stamp,
                  shear_error *err) {
    CLEANUP(release_free)
    double *pixels = calloc((size_t)s->nx * (size_t)s->ny, sizeof *pixels);
    shear_image image = {.cell = cell,
                         .pixels = pixels,
                         .nx = s->nx,
                         .ny = s->ny,
                         .stretch = SHEAR_ASINH,
                         .map = SHEAR_MAP_GREY,
                         .not_finite = {1.0, 0.45, 0.6, 1.0},
                         .x = {0.5, 0.5 + (double)s->nx * s->bin},
                         .y = {0.5, 0.5 + (double)s->ny * s->bin},
                         .equal = true,
                         .ticks = true,
                         .x_label = "x [px]",
                         .y_label = "y [px]"};
    if (pixels == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a picture");
    TRY(turn_over(pixels, s, &image.limits, &image.knee, err));
    shear_image_begin(f, &image);
    draw_noise_boxes(f, s, stamp);
    TRY(draw_galaxies(f, s, err));
    shear_axes_end(f);
    return SHEAR_OK;
}

/* ---- the PSF ---- */

/* Return a round number, 1, 2 or 5 times a power of ten, not above a positive one. */
static double round_below(double value) {
    const double power = pow(10.0, floor(log10(value)));
    const double part = value / power;
    return power * (part >= 5.0 ? 5.0 : part >= 2.0 ? 2.0 : 1.0);
}

static void draw_outline(shear_figure *f, const chip_survey *s) {
    const double xs[] = {0.5, s->chip.nx + 0.5, s->chip.nx + 0.5, 0.5, 0.5};
    const double ys[] = {0.5, 0.5, s->chip.ny + 0.5, s->chip.ny + 0.5, 0.5};
    const shear_style style = line_of(SHEAR_GREY, 1.0, 1.0);
    shear_axes_line(f, 5, xs, ys, &style);
}

static void draw_whisker(shear_figure *f, double x, double y, double dx, double dy) {
    const double xs[] = {x - dx, x + dx};
    const double ys[] = {y - dy, y + dy};
    const shear_style style = line_of(SHEAR_VERMILION, 1.0, 2.2);
    shear_axes_line(f, 2, xs, ys, &style);
}

/* Draw all ellipses enlarged, and lines along their longer axes, as long as they are elliptical:
 * `whisker` pixels per e. */
static void draw_ellipses(shear_figure *f, const chip_survey *s, double enlarged, double whisker) {
    const shear_style style = {.colour = shear_palette(SHEAR_BLUE), .width = 1.2, .fill = 0.12};
    for (int i = 0; i < s->n_psfs; i++) {
        const chip_psf *p = &s->psfs[i];
        const double angle = 0.5 * atan2(p->e2, p->e1);
        shear_axes_ellipse(f, p->x, p->y, p->cov, enlarged, &style);
        draw_whisker(f, p->x, p->y, 0.5 * whisker * p->e * cos(angle),
                     0.5 * whisker * p->e * sin(angle));
    }
}

/* ---- North and East ---- */

static void draw_arrow(shear_figure *f, double x, double y, double dx, double dy,
                       const char *name) {
    static const double head = 0.22;
    const double tip_x = x + dx;
    const double tip_y = y + dy;
    const double xs[] = {x, tip_x, tip_x - head * (dx - 0.5 * dy), tip_x,
                         tip_x - head * (dx + 0.5 * dy)};
    const double ys[] = {y, tip_y, tip_y - head * (dy + 0.5 * dx), tip_y,
                         tip_y - head * (dy - 0.5 * dx)};
    const shear_style style = line_of(SHEAR_BLACK, 1.0, 1.8);
    shear_axes_line(f, 5, xs, ys, &style);
    shear_axes_text(f, x + 1.3 * dx, y + 1.3 * dy, false, name,
                    &(shear_text_style){.size = 13.0, .bold = true, .align = 0.5});
}

/* Draw where North (v) and East (-u) are, by the inverse of the Jacobian. */
static void draw_compass(shear_figure *f, const chip_survey *s, double x, double y, double length) {
    const double *j = s->jacobian;
    const double det = j[0] * j[3] - j[1] * j[2];
    const double north[] = {-j[1] / det, j[0] / det};
    const double east[] = {-j[3] / det, j[2] / det};
    const double n = length / hypot(north[0], north[1]);
    const double e = length / hypot(east[0], east[1]);
    if (!isfinite(n) || !isfinite(e))
        return;
    draw_arrow(f, x, y, n * north[0], n * north[1], "N");
    draw_arrow(f, x, y, e * east[0], e * east[1], "E");
}

/* Draw the scale of the lines below the chip. */
static void draw_scale(shear_figure *f, const chip_survey *s, double y, double unit,
                       double whisker) {
    char text[PLOT_CELL];
    const double x = 0.04 * s->chip.nx;
    const double length = unit * whisker;
    draw_whisker(f, x + 0.5 * length, y, 0.5 * length, 0.0);
    plot_print(text, sizeof text, "|e| = %.3g", unit);
    shear_axes_text(f, x + length + 0.03 * s->chip.nx, y, false, text,
                    &(shear_text_style){.size = 12.0});
}

void chip_map_draw_psf(shear_figure *f, shear_rect cell, const chip_survey *s) {
    const double nx = s->chip.nx;
    const double ny = s->chip.ny;
    const double below = (isfinite(s->jacobian[0]) ? 0.36 : 0.12) * fmax(nx, ny);
    const double spacing = fmax(nx, ny) / CHIP_PSFS;
    double e = 1e-3;
    double sigma = 0.5;
    for (int i = 0; i < s->n_psfs; i++) {
        e = fmax(e, s->psfs[i].e);
        sigma = fmax(sigma, s->psfs[i].fwhm / 2.3548);
    }
    const double whisker = 0.8 * spacing / e;
    const double margin = 0.04 * fmax(nx, ny);
    const shear_axes axes = {.cell = cell,
                             .title = "PSF over the chip: ellipses enlarged, lines along e",
                             .equal = true,
                             .x = {.range = {-margin, nx + margin}, .bare = true},
                             .y = {.range = {-below, ny + margin}, .bare = true}};
    shear_axes_begin(f, &axes);
    draw_outline(f, s);
    draw_ellipses(f, s, 0.3 * spacing / sigma, whisker);
    draw_scale(f, s, -0.05 * fmax(nx, ny), round_below(e), whisker);
    draw_compass(f, s, 0.5 * nx, -0.62 * below, 0.26 * below);
    shear_axes_end(f);
}

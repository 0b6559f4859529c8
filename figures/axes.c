/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axes: the frame, the scales, ticks and labels. */
#include "internal.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

static const double TICK_LENGTH = 5.0;
static const double MINOR_LENGTH = 3.0;
static const double TICK_LABEL_ROOM = 20.0;
static const double BARE_ROOM = 8.0;

/* Return a range that can be drawn. */
static shear_range usable_range(const shear_axis *axis) {
    shear_range r = shear_range_pad(axis->range, 0.0);
    if (!axis->log)
        return isfinite(r.hi - r.lo) ? r : (shear_range){0.0, 1.0};
    r.hi = r.hi > 0.0 ? r.hi : 1.0;
    r.lo = r.lo > 0.0 && r.lo < r.hi ? r.lo : 1e-3 * r.hi;
    return r.lo >= DBL_MIN ? r : (shear_range){1e-3, 1.0}; /* powers of ten lose digits below */
}

shear_rect shear_axes_frame(const shear_figure *figure) {
    return figure->axes.frame;
}

static double widest_label(shear_figure *f, const shear_axis *axis, const shear_ticks *ticks) {
    const int n = axis->n_names > 0 ? axis->n_names : ticks->n;
    double widest = 0.0;
    for (int i = 0; i < n && !axis->bare; i++) {
        const char *label = axis->n_names > 0 ? axis->names[i] : ticks->label[i];
        widest = fmax(widest, shear_figure_text_width(f, label, TICK_SIZE));
    }
    return widest;
}

/* Choose as many ticks as fit with space between their labels, up to a limit. */
static void choose_ticks(shear_figure *f, const shear_axis *axis, double length, double spacing,
                         bool horizontal, shear_ticks *ticks) {
    *ticks = (shear_ticks){0};
    if (axis->n_names > 0)
        return;
    int at_most = (int)fmin(fmax(length / spacing, 2.0), 9.0);
    for (;; at_most--) {
        if (axis->log) {
            shear_ticks_log(ticks, axis->range.lo, axis->range.hi, at_most);
        } else {
            shear_ticks_linear(ticks, axis->range.lo, axis->range.hi, at_most);
        }
        const double taken = ticks->n * (widest_label(f, axis, ticks) + 12.0);
        if (!horizontal || at_most <= 2 || taken <= length + 20.0)
            return;
    }
}

/* Add the path of a frame: around the data's pixels, on the centres of the adjacent ones, so that
 * it is sharp and hides nothing. */
static void frame_path(shear_figure *f, shear_rect r) {
    figure_set_colour(f, shear_palette(SHEAR_BLACK));
    cairo_set_line_width(f->cr, FRAME_WIDTH);
    cairo_set_dash(f->cr, NULL, 0, 0.0);
    cairo_rectangle(f->cr, r.x - 0.5, r.y - 0.5, r.w + 1.0, r.h + 1.0);
}

/* Draw a tick at `place` along x (or y): inward on both edges of the frame or, over an image,
 * outward below (or left of) it. */
static void draw_tick(shear_figure *f, bool along_x, double place, double length) {
    const shear_rect r = f->axes.frame;
    const double at = floor(place) + 0.5;
    const double dx = along_x ? 0.0 : length;
    const double dy = along_x ? length : 0.0;
    if (f->axes.image) {
        cairo_move_to(f->cr, along_x ? at : r.x - 1.0, along_x ? r.y + r.h + 1.0 : at);
        cairo_rel_line_to(f->cr, -dx, dy);
        return;
    }
    cairo_move_to(f->cr, along_x ? at : r.x, along_x ? r.y + r.h : at);
    cairo_rel_line_to(f->cr, dx, -dy);
    cairo_move_to(f->cr, along_x ? at : r.x + r.w, along_x ? r.y : at);
    cairo_rel_line_to(f->cr, -dx, dy);
}

static double place_of(const open_axes *axes, bool along_x, double v) {
    return along_x ? axes_x(axes, v) : axes_y(axes, v);
}

/* Draw ticks at 2 to 9 times the powers of ten, unless the axis is too long for them. */
static void draw_minor_ticks(shear_figure *f, bool along_x) {
    const shear_axis *axis = along_x ? &f->axes.spec.x : &f->axes.spec.y;
    const shear_range r = axis->range;
    if (!axis->log || log10(r.hi / r.lo) > 8.0)
        return;
    const int last = (int)floor(log10(r.hi));
    for (int e = (int)floor(log10(r.lo)); e <= last; e++) {
        for (int digit = 2; digit < 10; digit++) {
            const double v = digit * pow(10.0, e);
            if (v > r.lo && v < r.hi)
                draw_tick(f, along_x, place_of(&f->axes, along_x, v), MINOR_LENGTH);
        }
    }
}

static void draw_ticks(shear_figure *f, bool along_x) {
    const open_axes *axes = &f->axes;
    const shear_ticks *ticks = along_x ? &axes->x_ticks : &axes->y_ticks;
    for (int i = 0; i < ticks->n; i++)
        draw_tick(f, along_x, place_of(axes, along_x, ticks->at[i]), TICK_LENGTH);
}

static void draw_power(shear_figure *f, double x, double y, double align, int exponent) {
    char text[32];
    snprintf(text, sizeof text,
             "\xc3\x97"
             "10^{%s%d}",
             exponent < 0 ? "\xe2\x88\x92" : "", exponent < 0 ? -exponent : exponent);
    shear_figure_text(f, x, y, text, &(shear_text_style){.size = TICK_SIZE, .align = align});
}

/* Draw names or numbers in one line; `across` is their position perpendicular to the axis. */
static void label_ticks(shear_figure *f, bool along_x, double across, double align) {
    const open_axes *axes = &f->axes;
    const shear_axis *axis = along_x ? &axes->spec.x : &axes->spec.y;
    const shear_ticks *ticks = along_x ? &axes->x_ticks : &axes->y_ticks;
    const shear_text_style style = {.size = TICK_SIZE, .align = align};
    const bool named = axis->n_names > 0;
    const int n = named ? axis->n_names : ticks->n;
    for (int i = 0; !axis->bare && i < n; i++) {
        const double along = place_of(axes, along_x, named ? i : ticks->at[i]);
        shear_figure_text(f, along_x ? along : across, along_x ? across : along,
                          named ? axis->names[i] : ticks->label[i], &style);
    }
}

static void label_x(shear_figure *f, const open_axes *axes, double outward) {
    const shear_axis *axis = &axes->spec.x;
    const shear_rect r = axes->frame;
    const double y = r.y + r.h + 11.0 + outward;
    const double below = axis->bare ? r.y + r.h + 14.0 : y + LABEL_ROOM - 1.0;
    label_ticks(f, true, y, 0.5);
    if (!axis->bare && axes->x_ticks.exponent != 0)
        draw_power(f, r.x + r.w, below, 1.0, axes->x_ticks.exponent);
    shear_figure_text(f, r.x + r.w / 2.0, below, axis->label,
                      &(shear_text_style){.size = LABEL_SIZE, .align = 0.5});
}

static void label_y(shear_figure *f, const open_axes *axes, double outward) {
    const shear_axis *axis = &axes->spec.y;
    const shear_rect r = axes->frame;
    const double x = r.x - 6.0 - outward;
    const double left = x - widest_label(f, axis, &axes->y_ticks) - 12.0;
    label_ticks(f, false, x, 1.0);
    if (!axis->bare && axes->y_ticks.exponent != 0)
        draw_power(f, r.x, r.y - 9.0, 0.0, axes->y_ticks.exponent);
    shear_figure_text(f, left, r.y + r.h / 2.0, axis->label,
                      &(shear_text_style){.size = LABEL_SIZE, .align = 0.5, .upward = true});
}

void axes_open(shear_figure *f, const shear_axes *spec, shear_rect frame) {
    open_axes *axes = &f->axes;
    if (axes->open) {
        figure_failed(f, SHEAR_E_INTERNAL, "axes within axes: a shear_axes_end is missing");
        return;
    }
    *axes = (open_axes){.open = true, .ticks = true, .spec = *spec};
    axes->frame = (shear_rect){round(frame.x), round(frame.y), fmax(round(frame.w), 1.0),
                               fmax(round(frame.h), 1.0)};
    axes->spec.x.range = usable_range(&spec->x);
    axes->spec.y.range = usable_range(&spec->y);
    choose_ticks(f, &axes->spec.x, axes->frame.w, 36.0, true, &axes->x_ticks);
    choose_ticks(f, &axes->spec.y, axes->frame.h, 34.0, false, &axes->y_ticks);
}

shear_rect axes_fit(shear_rect r, double wide, double high) {
    const double scale = fmin(r.w / wide, r.h / high);
    const double w = scale * wide;
    const double h = scale * high;
    return (shear_rect){r.x + (r.w - w) / 2.0, r.y + (r.h - h) / 2.0, w, h};
}

void shear_axes_begin(shear_figure *figure, const shear_axes *axes) {
    if (!figure_good(figure))
        return;
    const shear_axis *x = &axes->x;
    shear_axis y = axes->y;
    y.range = usable_range(&axes->y);
    const double top = axes->title != NULL ? TITLE_ROOM : BARE_ROOM;
    const double bottom =
        (x->bare ? BARE_ROOM : TICK_LABEL_ROOM) + (x->label != NULL ? LABEL_ROOM : 0.0);
    const double height = axes->cell.h - top - bottom;
    shear_ticks ticks;
    choose_ticks(figure, &y, height, 34.0, false, &ticks);
    const double left = axes->left > 0.0 ? axes->left
                                         : widest_label(figure, &y, &ticks) + 10.0 +
                                               (y.label != NULL ? LABEL_ROOM : 0.0);
    shear_rect frame = {axes->cell.x + left, axes->cell.y + top, axes->cell.w - left - 12.0,
                        height};
    if (axes->equal) {
        const shear_range across = usable_range(x);
        frame = axes_fit(frame, across.hi - across.lo, y.range.hi - y.range.lo);
    }
    axes_open(figure, axes, frame);
}

void shear_axes_end(shear_figure *figure) {
    if (!axes_ready(figure))
        return;
    const open_axes *axes = &figure->axes;
    const shear_rect r = axes->frame;
    const double outward = axes->image && axes->ticks ? TICK_LENGTH : 0.0;
    frame_path(figure, r);
    cairo_stroke(figure->cr);
    if (axes->ticks) {
        draw_ticks(figure, true);
        draw_ticks(figure, false);
        draw_minor_ticks(figure, true);
        draw_minor_ticks(figure, false);
        cairo_stroke(figure->cr);
        label_x(figure, axes, outward);
        label_y(figure, axes, outward);
    }
    shear_figure_text(figure, r.x + r.w / 2.0, r.y - 12.0, axes->spec.title,
                      &(shear_text_style){.size = TITLE_SIZE, .align = 0.5});
    legend_draw(figure);
    figure->axes.open = false;
}

void axes_draw_bar_ticks(shear_figure *f, shear_rect bar, const shear_stretch *stretch,
                         const shear_ticks *ticks) {
    frame_path(f, bar);
    for (int i = 0; i < ticks->n; i++) {
        const double part = shear_stretch_apply(stretch, ticks->at[i]);
        const double y = floor(bar.y + bar.h * (1.0 - part)) + 0.5;
        cairo_move_to(f->cr, bar.x + bar.w, y);
        cairo_rel_line_to(f->cr, 3.5, 0.0);
        shear_figure_text(f, bar.x + bar.w + 6.0, y, ticks->label[i],
                          &(shear_text_style){.size = TICK_SIZE - 0.5});
        figure_set_colour(f, shear_palette(SHEAR_BLACK));
    }
    cairo_stroke(f->cr);
    if (ticks->exponent != 0)
        draw_power(f, bar.x, bar.y - 9.0, 0.0, ticks->exponent);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Image panels: an array, a stretch, a colour map, a colour bar. */
#include "internal.h"

#include <math.h>

enum { MAX_IMAGE_SIDE = 32767 }; /* limit of a cairo surface */
static const double BAR_GAP = 6.0;
static const double BAR_WIDTH = 8.0;
static const double BAR_ROOM = 44.0;
static const double EDGE_ROOM = 6.0;
static const double TICK_ROOM = 26.0;
static const double TICK_LABEL_WIDTH = 36.0;

static uint32_t packed(shear_colour c) {
    return 0xff000000u | (uint32_t)lround(255.0 * c.r) << 16 | (uint32_t)lround(255.0 * c.g) << 8 |
           (uint32_t)lround(255.0 * c.b);
}

/* A table of the image's colours, with many more steps than a screen can show. */
enum { STEPS = 4096 };
typedef struct paint {
    uint32_t steps[STEPS + 1]; /* for brightness 0 .. 1 */
    uint32_t negative, not_finite;
    bool mark_negative;
} paint;

static void paint_init(paint *p, const shear_image *image) {
    for (int i = 0; i <= STEPS; i++)
        p->steps[i] = packed(shear_map_colour(image->map, (double)i / STEPS));
    p->negative = packed(shear_map_negative());
    p->not_finite = packed(image->not_finite.a > 0.0 ? image->not_finite : shear_map_not_finite());
    p->mark_negative = image->mark_negative;
}

static uint32_t paint_of(const paint *p, const shear_stretch *stretch, double value) {
    if (!isfinite(value))
        return p->not_finite;
    if (p->mark_negative && value < 0.0)
        return p->negative;
    return p->steps[lround(STEPS * shear_stretch_apply(stretch, value))];
}

/* Determine the stretch and its limits. Returns false on failure, which is kept. */
static bool find_stretch(shear_figure *f, const shear_image *image, shear_stretch *stretch) {
    shear_range limits = image->limits;
    shear_range percent = image->percentiles;
    if (!(limits.lo != limits.hi)) {
        if (!(percent.lo != percent.hi))
            percent = (shear_range){0.5, 99.8};
        shear_error err = {0};
        const size_t n = (size_t)image->nx * (size_t)image->ny;
        if (shear_range_percentile(&limits, image->pixels, n, percent.lo, percent.hi, &err) != 0) {
            figure_failed(f, err.code, err.message);
            return false;
        }
    }
    *stretch = shear_stretch_make(image->stretch, limits, image->knee);
    return true;
}

/* Convert the array to a surface of one pixel per sample, row 0 at the bottom. Returns NULL on
 * failure, which is kept. */
static cairo_surface_t *surface_of(shear_figure *f, const shear_image *image,
                                   const shear_stretch *stretch) {
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, image->nx, image->ny);
    if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
        cairo_surface_destroy(surface);
        figure_failed(f, SHEAR_E_NOMEM, "no memory for an image");
        return NULL;
    }
    paint p;
    paint_init(&p, image);
    unsigned char *data = cairo_image_surface_get_data(surface);
    const ptrdiff_t stride = cairo_image_surface_get_stride(surface);
    for (int row = 0; row < image->ny; row++) {
        const double *pixels = image->pixels + (ptrdiff_t)row * image->nx;
        uint32_t *out = (uint32_t *)(void *)(data + stride * (image->ny - 1 - row));
        for (int column = 0; column < image->nx; column++)
            out[column] = paint_of(&p, stretch, pixels[column]);
    }
    cairo_surface_mark_dirty(surface);
    return surface;
}

static void draw_surface(shear_figure *f, cairo_surface_t *surface, int nx, int ny) {
    const shear_rect r = f->axes.frame;
    const bool shrunk = r.w < nx || r.h < ny;
    cairo_save(f->cr);
    cairo_rectangle(f->cr, r.x, r.y, r.w, r.h);
    cairo_clip(f->cr);
    cairo_translate(f->cr, r.x, r.y);
    cairo_scale(f->cr, r.w / nx, r.h / ny);
    cairo_set_source_surface(f->cr, surface, 0.0, 0.0);
    cairo_pattern_t *pattern = cairo_get_source(f->cr);
    /* A reduced image is averaged: skipping pixels would cause moiré patterns. */
    cairo_pattern_set_filter(pattern, shrunk ? CAIRO_FILTER_GOOD : CAIRO_FILTER_NEAREST);
    cairo_pattern_set_extend(pattern, CAIRO_EXTEND_PAD);
    cairo_paint(f->cr);
    cairo_restore(f->cr);
}

static void draw_bar(shear_figure *f, const shear_image *image, const shear_stretch *stretch) {
    const shear_rect r = f->axes.frame;
    const shear_rect bar = {r.x + r.w + BAR_GAP, r.y, BAR_WIDTH, r.h};
    for (int i = 0; i < (int)bar.h; i++) {
        figure_set_colour(f, shear_map_colour(image->map, 1.0 - (i + 0.5) / bar.h));
        cairo_rectangle(f->cr, bar.x, bar.y + i, bar.w, 1.0);
        cairo_fill(f->cr);
    }
    shear_ticks ticks;
    shear_ticks_stretch(&ticks, stretch, (int)fmin(fmax(bar.h / 20.0, 2.0), 9.0));
    axes_draw_bar_ticks(f, bar, stretch, &ticks);
}

static shear_range outer_edges(shear_range given, int n) {
    return given.lo != given.hi ? given : (shear_range){-0.5, n - 0.5};
}

/* Return the largest frame with square pixels, after reserving space for titles, labels and the
 * colour bar. */
static shear_rect frame_of(const shear_image *image) {
    const double room = image->bar_room > 0.0 ? image->bar_room : BAR_ROOM;
    const double right = image->colour_bar ? BAR_GAP + BAR_WIDTH + room : EDGE_ROOM;
    const double top = image->title != NULL ? TITLE_ROOM : EDGE_ROOM;
    double left = 1.0;
    double bottom = EDGE_ROOM;
    if (image->ticks) {
        left = TICK_LABEL_WIDTH + (image->y_label != NULL ? LABEL_ROOM : 0.0);
        bottom = TICK_ROOM + (image->x_label != NULL ? LABEL_ROOM : 0.0);
    }
    const shear_rect r = {image->cell.x + left, image->cell.y + top,
                          fmax(image->cell.w - left - right, 1.0),
                          fmax(image->cell.h - top - bottom, 1.0)};
    const shear_range x = outer_edges(image->x, image->nx);
    const shear_range y = outer_edges(image->y, image->ny);
    return image->equal ? axes_fit(r, fabs(x.hi - x.lo), fabs(y.hi - y.lo))
                        : axes_fit(r, image->nx, image->ny);
}

void shear_image_begin(shear_figure *figure, const shear_image *image) {
    if (!figure_good(figure))
        return;
    if (image->pixels == NULL || image->nx < 1 || image->ny < 1 || image->nx > MAX_IMAGE_SIDE ||
        image->ny > MAX_IMAGE_SIDE) {
        figure_failed(figure, SHEAR_E_INTERNAL, "an image needs 1 to 32767 pixels per side");
        return;
    }
    const shear_axes axes = {
        .cell = image->cell,
        .title = image->title,
        .x = {.range = outer_edges(image->x, image->nx), .label = image->x_label},
        .y = {.range = outer_edges(image->y, image->ny), .label = image->y_label},
    };
    axes_open(figure, &axes, frame_of(image));
    figure->axes.image = true;
    figure->axes.ticks = image->ticks;
    shear_stretch stretch;
    if (!figure_good(figure) || !find_stretch(figure, image, &stretch))
        return;
    cairo_surface_t *surface = surface_of(figure, image, &stretch);
    if (surface == NULL)
        return;
    draw_surface(figure, surface, image->nx, image->ny);
    cairo_surface_destroy(surface);
    if (image->colour_bar)
        draw_bar(figure, image, &stretch);
}

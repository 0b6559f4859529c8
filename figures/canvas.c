/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The canvas: creation, the first failure, single pixels. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_SIDE = 20000 };

int shear_figure_new(shear_figure **figure, int width, int height, shear_error *err) {
    *figure = NULL;
    if (width < 1 || height < 1 || width > MAX_SIDE || height > MAX_SIDE) {
        return shear_fail(err, SHEAR_E_SETTING, "choose a size between 1 and 20000 pixels per side",
                          "a figure of %d x %d pixels cannot be drawn", width, height);
    }
    shear_figure *f = calloc(1, sizeof *f);
    if (f == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for a figure");
    f->width = width;
    f->height = height;
    f->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    f->cr = cairo_create(f->surface);
    if (cairo_status(f->cr) != CAIRO_STATUS_SUCCESS) {
        shear_figure_free(f);
        return shear_fail(err, SHEAR_E_NOMEM, "make the figure smaller",
                          "no memory for a figure of %d x %d pixels", width, height);
    }
    cairo_set_source_rgb(f->cr, 1.0, 1.0, 1.0);
    cairo_paint(f->cr);
    cairo_set_line_join(f->cr, CAIRO_LINE_JOIN_ROUND);
    *figure = f;
    return SHEAR_OK;
}

void shear_figure_free(shear_figure *figure) {
    if (figure == NULL)
        return;
    cairo_destroy(figure->cr);
    cairo_surface_destroy(figure->surface);
    free(figure);
}

void figure_failed(shear_figure *f, int code, const char *message) {
    if (f->error.code == SHEAR_OK)
        shear_fail(&f->error, code, NULL, "%s", message);
}

bool figure_good(shear_figure *f) {
    const cairo_status_t status = cairo_status(f->cr);
    if (status != CAIRO_STATUS_SUCCESS) {
        figure_failed(f, status == CAIRO_STATUS_NO_MEMORY ? SHEAR_E_NOMEM : SHEAR_E_INTERNAL,
                      cairo_status_to_string(status));
    }
    return f->error.code == SHEAR_OK;
}

void figure_set_colour(shear_figure *f, shear_colour colour) {
    if (colour.a == 0.0)
        colour = shear_palette(SHEAR_BLACK);
    cairo_set_source_rgba(f->cr, colour.r, colour.g, colour.b, colour.a);
}

uint32_t shear_figure_pixel(shear_figure *figure, int x, int y) {
    uint32_t pixel = 0xffffff;
    if (x >= 0 && y >= 0 && x < figure->width && y < figure->height) {
        cairo_surface_flush(figure->surface);
        const unsigned char *row = cairo_image_surface_get_data(figure->surface) +
                                   (ptrdiff_t)y * cairo_image_surface_get_stride(figure->surface);
        memcpy(&pixel, row + (ptrdiff_t)x * 4, sizeof pixel);
    }
    return pixel & 0xffffff;
}

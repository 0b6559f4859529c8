/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One row of a sheet: a stamp through all steps of its measurement. */
#include "plot/sheet.h"
#include "plot/text.h"

#include "base/cleanup.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static const double POWER_DEPTH = 1e-6; /* range of the spectra's colour scale */
static const double BAR_ROOM = 38.0;

shear_image sheet_cut_image(shear_rect cell, const char *title, const plot_cut *cut) {
    return (shear_image){.cell = cell,
                         .title = title,
                         .pixels = cut->pixels,
                         .nx = cut->nx,
                         .ny = cut->ny,
                         .stretch = SHEAR_LOG,
                         .not_finite = {0.93, 0.93, 0.93, 1.0},
                         .x = cut->x,
                         .y = cut->y,
                         .equal = true,
                         .colour_bar = true};
}

plot_lattice sheet_modes(const stamp_reader *b, const shear_inspection *steps) {
    const double two_pi = 2.0 * acos(-1.0);
    return (plot_lattice){.nx = steps->spec_nx,
                          .ny = steps->spec_ny,
                          .x0 = (steps->spec_nx - 1) / 2.0, /* odd sizes: k = 0 is in the middle */
                          .y0 = (steps->spec_ny - 1) / 2.0,
                          .step_x = two_pi / b->info->geometry.nx,
                          .step_y = two_pi / b->info->geometry.ny};
}

int sheet_cut_modes(plot_cut *cut, const double *modes, const stamp_reader *b,
                    const shear_inspection *steps, shear_error *err) {
    const plot_lattice lattice = sheet_modes(b, steps);
    const double k_cut = b->chosen->k_cut;
    TRY(plot_cut_init(cut, modes, &lattice, k_cut + fmax(lattice.step_x, lattice.step_y), err));
    for (int j = 0; j < cut->ny; j++) {
        const double ky = cut->y.lo + (j + 0.5) * lattice.step_y;
        for (int i = 0; i < cut->nx; i++) {
            const double kx = cut->x.lo + (i + 0.5) * lattice.step_x;
            double *mode = &cut->pixels[(size_t)j * (size_t)cut->nx + (size_t)i];
            *mode = hypot(kx, ky) < k_cut * (1.0 - 1e-9) ? *mode : NAN;
        }
    }
    return SHEAR_OK;
}

static void heading(shear_figure *f, const shear_grid *grid, int column, double y,
                    const char *first, const char *second) {
    const shear_rect cell = shear_grid_cell(grid, 0, column, 1, 1);
    const double middle = cell.x + (cell.w - BAR_ROOM - 14.0) / 2.0; /* of the image */
    shear_figure_text(f, middle, y, first,
                      &(shear_text_style){.size = 13.0, .bold = true, .align = 0.5});
    shear_figure_text(f, middle, y + 17.0, second, &(shear_text_style){.size = 10.5, .align = 0.5});
}

static void describe_filter(char *text, size_t size, const shear_plan_info *p) {
    if (p->filter == SHEAR_FILTER_NONE) {
        snprintf(text, size, "no filter");
    } else if (p->filter_per_stamp) {
        plot_print(text, size, "R_{core} = R_{G} + 4\xce\xb2, R_{width} = %.3g px", p->width_px);
    } else {
        plot_print(text, size, "R_{core} = %.3g, R_{width} = %.3g px", p->core_px, p->width_px);
    }
}

void sheet_draw_headings(shear_figure *f, const shear_grid *grid, double y, const stamp_reader *b) {
    const shear_plan_info *p = b->chosen;
    const bool corrected = shear_plan_get_settings(b->plan)->noise_correction;
    char text[96];
    heading(f, grid, 0, y, "galaxy", "asinh scale, file's units");
    heading(f, grid, 1, y, "noise", "linear scale");
    snprintf(text, sizeof text, "%s, s = %d", shear_interpolation_name(p->interpolation),
             p->oversample);
    heading(f, grid, 2, y, "interpolated",
            p->interpolation == SHEAR_INTERP_NONE ? "none: the pixels as they are" : text);
    describe_filter(text, sizeof text, p);
    heading(f, grid, 3, y, "filtered", text);
    plot_print(text, sizeof text, "%s, |k| < %.2f rad/px",
               corrected ? "noise subtracted" : "not corrected", p->k_cut);
    heading(f, grid, 4, y, "power |F|^{2}", text);
    plot_print(text, sizeof text, "target PSF, \xce\xb2 = %.3g px", p->beta_px);
    heading(f, grid, 5, y, "P(k) = T |F|^{2}", text);
}

/* Use one brightness scale for the galaxy before and after interpolation and filter. */
static int galaxy_scale(shear_image *image, const sheet_stamp *stamp, size_t n, shear_error *err) {
    shear_range noise;
    image->stretch = SHEAR_ASINH;
    TRY(shear_range_percentile(&image->limits, stamp->galaxy, n, 1.0, 100.0, err));
    int code = shear_range_percentile(&noise, stamp->noise, n, 16.0, 84.0, err);
    image->knee = noise.hi - noise.lo; /* 2 sigma; automatic if it is 0 or NaN (no noise) */
    return code;
}

static void draw_image(shear_figure *f, const shear_image *image) {
    shear_image_begin(f, image);
    shear_axes_end(f);
}

static int draw_pixels(shear_figure *f, const shear_grid *grid, int row, const stamp_reader *b,
                       const sheet_stamp *stamp, shear_error *err) {
    const shear_geometry *g = &b->info->geometry;
    shear_image image = {.cell = shear_grid_cell(grid, row, 0, 1, 1),
                         .pixels = stamp->galaxy,
                         .nx = g->nx,
                         .ny = g->ny,
                         .colour_bar = true,
                         .bar_room = BAR_ROOM};
    shear_image noise = image;
    noise.cell = shear_grid_cell(grid, row, 1, 1, 1);
    noise.pixels = stamp->noise;
    TRY(galaxy_scale(&image, stamp, (size_t)g->nx * (size_t)g->ny, err));
    draw_image(f, &image);
    draw_image(f, &noise);
    if (stamp->measured) {
        image.nx = stamp->steps.fine_nx;
        image.ny = stamp->steps.fine_ny;
        image.cell = shear_grid_cell(grid, row, 2, 1, 1);
        image.pixels = stamp->steps.galaxy_fine;
        draw_image(f, &image);
        image.cell = shear_grid_cell(grid, row, 3, 1, 1);
        image.pixels = stamp->steps.galaxy_filtered;
        draw_image(f, &image);
    }
    return SHEAR_OK;
}

static int draw_modes(shear_figure *f, shear_rect cell, const stamp_reader *b, const double *modes,
                      const shear_inspection *steps, shear_error *err) {
    CLEANUP(plot_cut_deinit) plot_cut cut = {0};
    TRY(sheet_cut_modes(&cut, modes, b, steps, err));
    const double peak = plot_cut_range(&cut).hi;
    shear_image image = sheet_cut_image(cell, NULL, &cut);
    image.limits = (shear_range){POWER_DEPTH * peak, peak};
    image.bar_room = BAR_ROOM;
    draw_image(f, &image);
    return SHEAR_OK;
}

static void draw_label(shear_figure *f, shear_rect cell, const sheet_stamp *stamp) {
    char text[64];
    if (isfinite(stamp->row.snr)) {
        plot_print(text, sizeof text, "stamp %" PRId64 ", S/N %.3g", stamp->index, stamp->row.snr);
    } else {
        plot_print(text, sizeof text, "stamp %" PRId64, stamp->index);
    }
    shear_figure_text(f, cell.x - 14.0, cell.y + cell.h / 2.0, text,
                      &(shear_text_style){.align = 0.5, .upward = true});
}

/* Print the flags of a stamp that is left out and so has no further steps. */
static void draw_flags(shear_figure *f, shear_rect cell, uint32_t flags) {
    double y = cell.y + cell.h / 2.0 - 14.0;
    shear_figure_text(f, cell.x + 10.0, y, "left out of the measurement:",
                      &(shear_text_style){.colour = shear_palette(SHEAR_VERMILION)});
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        if (flags >> bit & 1) {
            y += 18.0;
            shear_figure_text(f, cell.x + 10.0, y, shear_flag_help(bit), &(shear_text_style){0});
        }
    }
}

int sheet_draw_stamp(shear_figure *f, const shear_grid *grid, int row, const stamp_reader *b,
                     const sheet_stamp *stamp, shear_error *err) {
    const shear_inspection *steps = &stamp->steps;
    draw_label(f, shear_grid_cell(grid, row, 0, 1, 1), stamp);
    int code = draw_pixels(f, grid, row, b, stamp, err);
    if (code != SHEAR_OK || !stamp->measured) {
        draw_flags(f, shear_grid_cell(grid, row, 2, 1, 4), stamp->row.flags);
        return code;
    }
    TRY(draw_modes(f, shear_grid_cell(grid, row, 4, 1, 1), b, steps->power, steps, err));
    return draw_modes(f, shear_grid_cell(grid, row, 5, 1, 1), b, steps->target_power, steps, err);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The last row of the sheet: the PSF, its transfer, the spectra's profiles, the plan. */
#include "plot/sheet.h"
#include "plot/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

static const double PSF_DEPTH = 1e-4; /* of the PSF's colours */
static const double PROFILE_DEPTH = 1e-8;
static const double PSF_REACH = 6.0; /* R_PSF shown around the centre */

static int draw_psf(shear_figure *f, shear_rect cell, const stamp_reader *b, const double *psf,
                    shear_error *err) {
    const shear_geometry *g = &b->info->geometry;
    const double step = 1.0 / g->psf_oversample;
    const double radius = b->chosen->r_psf_px;
    plot_lattice lattice = {.nx = g->psf_nx, .ny = g->psf_ny, .step_x = step, .step_y = step};
    plot_cut cut;
    plot_core_centre(psf, g->psf_nx, g->psf_ny, &lattice.x0, &lattice.y0);
    const int code = plot_cut_new(&cut, psf, &lattice, fmax(PSF_REACH * radius, 3.0 * step), err);
    if (code != SHEAR_OK) {
        return code;
    }
    const double peak = shear_range_of(cut.pixels, (size_t)cut.nx * (size_t)cut.ny).hi;
    const shear_image image = {.cell = cell,
                               .title = "PSF, log scale",
                               .pixels = cut.pixels,
                               .nx = cut.nx,
                               .ny = cut.ny,
                               .stretch = SHEAR_LOG,
                               .limits = {PSF_DEPTH * peak, peak},
                               .x = cut.x,
                               .y = cut.y,
                               .equal = true,
                               .ticks = true,
                               .x_label = "x [px]",
                               .colour_bar = true};
    const shear_colour white = {1.0, 1.0, 1.0, 1.0};
    shear_image_begin(f, &image);
    shear_axes_circle(f, 0.0, 0.0, radius, &(shear_style){.colour = white, .width = 1.6});
    shear_axes_text(f, 0.04, 0.92, true, "circle: R_{PSF}", &(shear_text_style){.colour = white});
    shear_axes_end(f);
    plot_cut_free(&cut);
    return SHEAR_OK;
}

static int draw_transfer(shear_figure *f, shear_rect cell, const stamp_reader *b,
                         const shear_inspection *steps, shear_error *err) {
    plot_cut cut;
    const int code = sheet_cut_modes(&cut, steps->transfer, b, steps, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const shear_range range = shear_range_of(cut.pixels, (size_t)cut.nx * (size_t)cut.ny);
    const shear_image image = {.cell = cell,
                               .title = "transfer T(k), log scale",
                               .pixels = cut.pixels,
                               .nx = cut.nx,
                               .ny = cut.ny,
                               .stretch = SHEAR_LOG,
                               .limits = {fmax(range.lo, PROFILE_DEPTH * range.hi), range.hi},
                               .not_finite = sheet_left_out(),
                               .x = cut.x,
                               .y = cut.y,
                               .equal = true,
                               .ticks = true,
                               .x_label = "k_{x} [rad/px]",
                               .colour_bar = true};
    shear_image_begin(f, &image);
    shear_axes_end(f);
    plot_cut_free(&cut);
    return SHEAR_OK;
}

/* Azimuthal means over |k|. */
typedef struct profiles {
    int bins;
    double *k, *power, *target_power, *transfer, *target, *psf; /* [bins]; k owns all */
} profiles;

static int profiles_new(profiles *p, const stamp_reader *b, const shear_inspection *steps,
                        shear_error *err) {
    const plot_lattice modes = sheet_modes(b, steps);
    const double width = fmax(modes.step_x, modes.step_y);
    p->bins = (int)fmin(fmax(floor(b->chosen->k_cut / width - 0.5), 0.0), 1e5) + 1;
    const size_t n = (size_t)p->bins;
    p->k = calloc(6 * n, sizeof *p->k);
    if (p->k == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for profiles");
    }
    p->power = p->k + n;
    p->target_power = p->k + 2 * n;
    p->transfer = p->k + 3 * n;
    p->target = p->k + 4 * n;
    p->psf = p->k + 5 * n;
    int code = plot_radial_mean(p->power, p->bins, width, steps->power, &modes, err);
    if (code == SHEAR_OK) {
        code = plot_radial_mean(p->target_power, p->bins, width, steps->target_power, &modes, err);
    }
    if (code == SHEAR_OK) {
        code = plot_radial_mean(p->transfer, p->bins, width, steps->transfer, &modes, err);
    }
    for (int i = 0; i < p->bins; i++) {
        p->k[i] = i * width;
        p->target[i] = exp(-b->chosen->beta_px * b->chosen->beta_px * p->k[i] * p->k[i]);
        p->psf[i] = p->target[i] / p->transfer[i];
    }
    return code;
}

static void as_parts(double *v, int n) {
    const double largest = shear_range_of(v, (size_t)n).hi;
    for (int i = 0; i < n; i++) {
        v[i] /= largest;
    }
}

static int draw_profiles(shear_figure *f, shear_rect cell, const stamp_reader *b,
                         const shear_inspection *steps, int64_t index, shear_error *err) {
    profiles p = {0};
    char label[64];
    const int code = profiles_new(&p, b, steps, err);
    if (code != SHEAR_OK || p.k == NULL) {
        free(p.k);
        return code;
    }
    const size_t n = (size_t)p.bins;
    as_parts(p.power, p.bins);
    as_parts(p.target_power, p.bins);
    plot_print(label, sizeof label, "|F|^{2} of stamp %" PRId64, index);
    const double k_cut = b->chosen->k_cut;
    const shear_axes axes = {.cell = cell,
                             .title = "azimuthal means, parts of the largest",
                             .x = {.range = {0.0, 1.6 * k_cut}, .label = "|k| [rad/px]"},
                             .y = {.range = {PROFILE_DEPTH, 4.0}, .log = true}};
    shear_axes_begin(f, &axes);
    shear_axes_vline(f, k_cut,
                     &(shear_style){.colour = shear_palette(SHEAR_GREY), .dash = SHEAR_DASHED});
    shear_axes_line(f, n, p.k, p.psf,
                    &(shear_style){.colour = shear_palette(SHEAR_GREY), .label = "PSF |W|^{2}"});
    shear_axes_line(f, n, p.k, p.transfer,
                    &(shear_style){.colour = shear_palette(SHEAR_GREEN), .label = "T(k)"});
    shear_axes_line(f, n, p.k, p.target,
                    &(shear_style){.dash = SHEAR_DASHED, .label = "target |W_{\xce\xb2}|^{2}"});
    shear_axes_line(f, n, p.k, p.power,
                    &(shear_style){.colour = shear_palette(SHEAR_BLUE), .label = label});
    shear_axes_line(f, n, p.k, p.target_power,
                    &(shear_style){.colour = shear_palette(SHEAR_VERMILION), .label = "its P(k)"});
    shear_axes_text(f, k_cut, 4.0 * PROFILE_DEPTH, false, " k_{cut}", &(shear_text_style){0});
    shear_axes_end(f);
    free(p.k);
    return SHEAR_OK;
}

static void add_filter(plot_table *t, const shear_plan_info *p) {
    if (p->filter == SHEAR_FILTER_NONE) {
        plot_table_add(t, "filter", "none");
        return;
    }
    plot_table_add(t, "filter", "%s", shear_filter_name(p->filter));
    if (p->filter_per_stamp) {
        plot_table_add(t, "", "R_{core} = R_{G} + 4\xce\xb2");
    } else {
        plot_table_add(t, "", "R_{core} = %.3f px", p->core_px);
    }
    plot_table_add(t, "", "R_{width} = %.3f px", p->width_px);
}

static void draw_numbers(shear_figure *f, shear_rect cell, const stamp_reader *b) {
    const shear_plan_info *p = b->chosen;
    const shear_field_info *info = b->info;
    plot_table t = {0};
    plot_table_add(&t, "R_{PSF}", "%.3f px%s", p->r_psf_px, info->n_psf > 1 ? ", the median" : "");
    plot_table_add(&t, "\xce\xb2", "%.3f px = %.3g R_{PSF}", p->beta_px, p->beta_px / p->r_psf_px);
    plot_table_add(&t, "interpolation", "%s", shear_interpolation_name(p->interpolation));
    plot_table_add(&t, "fine grid", "s = %d, %d \xc3\x97 %d", p->oversample, p->fine_nx,
                   p->fine_ny);
    plot_table_add(&t, "PSF image", "%d \xc3\x97 %d, %d per px", info->geometry.psf_nx,
                   info->geometry.psf_ny, info->geometry.psf_oversample);
    add_filter(&t, p);
    plot_table_add(&t, "k_{cut}", "%.3f rad/px = %.3g \xcf\x80", p->k_cut, p->k_cut / acos(-1.0));
    plot_table_add(&t, "noise",
                   shear_plan_get_settings(b->plan)->noise_correction ? "subtracted"
                                                                      : "not subtracted");
    if (isfinite(info->pixscale)) {
        plot_table_add(&t, "pixel", "%.4g arcsec", info->pixscale);
    }
    if (info->has_truth) {
        plot_table_add(&t, "true shear", "(%.4f, %.4f)", info->sim_g1, info->sim_g2);
    }
    plot_table_draw(&t, f, cell, "Plan");
}

static int draw_spectra(shear_figure *f, const shear_grid *grid, const stamp_reader *b,
                        const plot_stamp *stamp, shear_error *err) {
    const int code = draw_transfer(f, shear_grid_cell(grid, 0, 1, 1, 1), b, &stamp->steps, err);
    return code != SHEAR_OK ? code
                            : draw_profiles(f, shear_grid_cell(grid, 0, 2, 1, 1), b, &stamp->steps,
                                            stamp->index, err);
}

int sheet_draw_plan(shear_figure *f, shear_rect area, const stamp_reader *b,
                    const plot_stamp *stamp, shear_error *err) {
    static const double widths[4] = {1.0, 1.0, 1.55, 0.85};
    const shear_grid grid = {
        .area = area, .rows = 1, .columns = 4, .gap_x = 16.0, .column_weights = widths};
    double *psf = NULL;
    int code = plot_stamp_psf(&psf, b, err);
    if (code == SHEAR_OK) {
        code = draw_psf(f, shear_grid_cell(&grid, 0, 0, 1, 1), b, psf, err);
    }
    free(psf);
    if (code == SHEAR_OK && stamp->measured) {
        code = draw_spectra(f, &grid, b, stamp, err);
    }
    draw_numbers(f, shear_grid_cell(&grid, 0, 3, 1, 1), b);
    return code;
}

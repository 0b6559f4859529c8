/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The last row of a sheet: the PSF, its transfer, the profiles of the spectra, the plan. */
#include "plot/sheet.h"
#include "plot/text.h"

#include "base/cleanup.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

static const double PSF_DEPTH = 1e-4; /* range of the PSF's colour scale */
static const double PROFILE_DEPTH = 1e-8;
static const double PSF_REACH = 6.0; /* R_PSF shown around the centre */

/* Return what is shown of the PSF: its core, or all its modes. */
static int cut_psf(plot_cut *cut, const sheet_psf *psf, double radius, shear_error *err) {
    plot_lattice lattice = {.nx = psf->nx, .ny = psf->ny, .step_x = psf->step, .step_y = psf->step};
    plot_core_centre(psf->pixels, psf->nx, psf->ny, &lattice.x0, &lattice.y0);
    const double reach = psf->power ? INFINITY : fmax(PSF_REACH * radius, 3.0 * psf->step);
    return plot_cut_init(cut, psf->pixels, &lattice, reach, err);
}

static int draw_psf(shear_figure *f, shear_rect cell, const stamp_reader *b, const sheet_psf *psf,
                    shear_error *err) {
    const double radius = b->chosen->r_psf_px;
    CLEANUP(plot_cut_deinit) plot_cut cut = {0};
    TRY(cut_psf(&cut, psf, radius, err));
    const double peak = plot_cut_range(&cut).hi;
    const shear_colour white = {1.0, 1.0, 1.0, 1.0};
    shear_image image =
        sheet_cut_image(cell, psf->power ? "PSF |W|^{2}, log scale" : "PSF, log scale", &cut);
    image.limits = (shear_range){PSF_DEPTH * peak, peak};
    image.ticks = true;
    image.x_label = psf->power ? "k_{x} [rad/px]" : "x [px]";
    shear_image_begin(f, &image);
    if (!psf->power) {
        shear_axes_circle(f, 0.0, 0.0, radius, &(shear_style){.colour = white, .width = 1.6});
        shear_axes_text(f, 0.04, 0.92, true, "circle: R_{PSF}",
                        &(shear_text_style){.colour = white});
    }
    shear_axes_end(f);
    return SHEAR_OK;
}

static int draw_transfer(shear_figure *f, shear_rect cell, const stamp_reader *b,
                         const shear_inspection *steps, shear_error *err) {
    CLEANUP(plot_cut_deinit) plot_cut cut = {0};
    TRY(sheet_cut_modes(&cut, steps->transfer, b, steps, err));
    const shear_range range = plot_cut_range(&cut);
    shear_image image = sheet_cut_image(cell, "transfer T(k), log scale", &cut);
    image.limits = (shear_range){fmax(range.lo, PROFILE_DEPTH * range.hi), range.hi};
    image.ticks = true;
    image.x_label = "k_{x} [rad/px]";
    shear_image_begin(f, &image);
    shear_axes_end(f);
    return SHEAR_OK;
}

/* The azimuthal means, as functions of |k|. */
enum {
    PROFILE_K,
    PROFILE_POWER,
    PROFILE_TARGET_POWER,
    PROFILE_TRANSFER,
    PROFILE_TARGET,
    PROFILE_PSF,
    N_PROFILES
};
typedef struct profiles {
    int bins;
    double *of[N_PROFILES]; /* [bins]; all in the allocation of the first */
} profiles;

static void profiles_deinit(profiles *p) {
    free(p->of[0]);
}

static int profiles_init(profiles *p, const stamp_reader *b, const shear_inspection *steps,
                         shear_error *err) {
    const plot_lattice modes = sheet_modes(b, steps);
    const double width = fmax(modes.step_x, modes.step_y);
    const double beta = b->chosen->beta_px;
    const double *const spectra[] = {steps->power, steps->target_power, steps->transfer};
    p->bins = (int)fmin(fmax(floor(b->chosen->k_cut / width - 0.5), 0.0), 1e5) + 1;
    p->of[0] = calloc((size_t)p->bins * N_PROFILES, sizeof **p->of);
    if (p->of[0] == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for profiles");
    for (int i = 1; i < N_PROFILES; i++)
        p->of[i] = p->of[i - 1] + p->bins;
    for (int i = 0; i < 3; i++)
        TRY(plot_radial_mean(p->of[PROFILE_POWER + i], p->bins, width, spectra[i], &modes, err));
    for (int i = 0; i < p->bins; i++) {
        const double k = i * width;
        p->of[PROFILE_K][i] = k;
        p->of[PROFILE_TARGET][i] = exp(-beta * beta * k * k);
        p->of[PROFILE_PSF][i] = p->of[PROFILE_TARGET][i] / p->of[PROFILE_TRANSFER][i];
    }
    return SHEAR_OK;
}

static void as_parts(double *v, int n) {
    const double largest = shear_range_of(v, (size_t)n).hi;
    for (int i = 0; i < n; i++)
        v[i] /= largest;
}

static int draw_profiles(shear_figure *f, shear_rect cell, const stamp_reader *b,
                         const sheet_stamp *stamp, shear_error *err) {
    CLEANUP(profiles_deinit) profiles p = {0};
    char label[64];
    TRY(profiles_init(&p, b, &stamp->steps, err));
    as_parts(p.of[PROFILE_POWER], p.bins);
    as_parts(p.of[PROFILE_TARGET_POWER], p.bins);
    plot_print(label, sizeof label, "|F|^{2} of stamp %" PRId64, stamp->index);
    const double k_cut = b->chosen->k_cut;
    const shear_colour grey = shear_palette(SHEAR_GREY);
    const shear_axes axes = {.cell = cell,
                             .title = "azimuthal means, parts of the largest",
                             .x = {.range = {0.0, 1.6 * k_cut}, .label = "|k| [rad/px]"},
                             .y = {.range = {PROFILE_DEPTH, 4.0}, .log = true}};
    const struct {
        int profile;
        shear_style style;
    } lines[] = {
        {PROFILE_PSF, {.colour = grey, .label = "PSF |W|^{2}"}},
        {PROFILE_TRANSFER, {.colour = shear_palette(SHEAR_GREEN), .label = "T(k)"}},
        {PROFILE_TARGET, {.dash = SHEAR_DASHED, .label = "target |W_{\xce\xb2}|^{2}"}},
        {PROFILE_POWER, {.colour = shear_palette(SHEAR_BLUE), .label = label}},
        {PROFILE_TARGET_POWER, {.colour = shear_palette(SHEAR_VERMILION), .label = "its P(k)"}}};
    shear_axes_begin(f, &axes);
    shear_axes_vline(f, k_cut, &(shear_style){.colour = grey, .dash = SHEAR_DASHED});
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        shear_axes_line(f, (size_t)p.bins, p.of[PROFILE_K], p.of[lines[i].profile],
                        &lines[i].style);
    }
    shear_axes_text(f, k_cut, 4.0 * PROFILE_DEPTH, false, " k_{cut}", &(shear_text_style){0});
    shear_axes_end(f);
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

static void draw_numbers(shear_figure *f, shear_rect cell, const stamp_reader *b,
                         const sheet_psf *psf) {
    const shear_plan_info *p = b->chosen;
    const shear_field_info *info = b->info;
    plot_table t = {0};
    plot_table_add(&t, "R_{PSF}", "%.3f px%s", p->r_psf_px, info->n_psf > 1 ? ", the median" : "");
    plot_table_add(&t, "\xce\xb2", "%.3f px = %.3g R_{PSF}", p->beta_px, p->beta_px / p->r_psf_px);
    plot_table_add(&t, "interpolation", "%s", shear_interpolation_name(p->interpolation));
    plot_table_add(&t, "fine grid", "s = %d, %d \xc3\x97 %d", p->oversample, p->fine_nx,
                   p->fine_ny);
    if (info->n_models == 0) {
        plot_table_add(&t, "PSF image", "%d \xc3\x97 %d, %g per px", psf->nx, psf->ny,
                       info->geometry.psf_oversample);
    } else {
        plot_table_add(&t, "PSF model", "%d \xc3\x97 %d of %.3g %s", psf->nx, psf->ny, psf->step,
                       psf->power ? "rad/px" : "px");
    }
    add_filter(&t, p);
    plot_table_add(&t, "k_{cut}", "%.3f rad/px = %.3g \xcf\x80", p->k_cut, p->k_cut / acos(-1.0));
    plot_table_add(&t, "noise",
                   shear_plan_get_settings(b->plan)->noise_correction ? "subtracted"
                                                                      : "not subtracted");
    if (isfinite(info->pixscale))
        plot_table_add(&t, "pixel", "%.4g arcsec", info->pixscale);
    if (info->has_truth)
        plot_table_add(&t, "true shear", "(%.4f, %.4f)", info->sim_g1, info->sim_g2);
    plot_table_draw(&t, f, cell, "Plan");
}

int sheet_draw_plan(shear_figure *f, shear_rect area, const stamp_reader *b,
                    const sheet_stamp *stamp, shear_error *err) {
    static const double widths[4] = {1.0, 1.0, 1.55, 0.85};
    const shear_grid grid = {
        .area = area, .rows = 1, .columns = 4, .gap_x = 16.0, .column_weights = widths};
    CLEANUP(sheet_psf_deinit) sheet_psf psf = {0};
    TRY(stamp_reader_psf(&psf, b, err));
    draw_numbers(f, shear_grid_cell(&grid, 0, 3, 1, 1), b, &psf);
    TRY(draw_psf(f, shear_grid_cell(&grid, 0, 0, 1, 1), b, &psf, err));
    if (!stamp->measured)
        return SHEAR_OK;
    TRY(draw_transfer(f, shear_grid_cell(&grid, 0, 1, 1, 1), b, &stamp->steps, err));
    return draw_profiles(f, shear_grid_cell(&grid, 0, 2, 1, 1), b, stamp, err);
}

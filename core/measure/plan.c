/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/internal.h"

#include "base/cleanup.h"
#include "common/release.h"
#include "measure/memory.h"

#include <stdlib.h>

/* A PSF made by FFTs has negative samples of this fraction of its peak; log methods treat them as
 * 0. */
static const double psf_rounding = 1e-4;

static bool make_grids(shear_plan *plan, int psf_factor) {
    const shear_plan_info *info = &plan->info;
    const shear_settings *set = &plan->settings;
    const shear_geometry *g = &info->geometry;
    transfer_plan *tp = &plan->transfer_plan;
    *tp = (transfer_plan){.nx = g->nx,
                          .ny = g->ny,
                          .s = info->oversample,
                          .psf_nx = g->psf_nx,
                          .psf_ny = g->psf_ny,
                          .q = info->psf_oversample,
                          .beta_px = info->beta_px,
                          .threshold = set->psf_threshold,
                          .power_tolerance = set->power_tolerance};
    const enum shear_interpolation psf_method =
        psf_factor > 1 ? info->interpolation : SHEAR_INTERP_NONE;
    const bool grid_made = surface_grid_init(&plan->grid, g->nx, g->ny, info->interpolation,
                                             info->oversample, set->zeros, set->pedestal);
    const bool psf_grid_made =
        surface_grid_init(&tp->grid, g->psf_nx, g->psf_ny, psf_method, psf_factor, set->zeros, 0.0);
    tp->grid.rounding = psf_rounding;
    const bool transfer_made = transfer_plan_init(tp);
    plan->along_x = fft_plan_new(info->fine_nx);
    plan->along_y = fft_plan_new(info->fine_ny);
    return grid_made && psf_grid_made && transfer_made && plan->along_x != NULL &&
           plan->along_y != NULL;
}

bool plan_init_filters(filter_map *fine, filter_map *coarse, const shear_plan_info *info) {
    const shear_geometry *g = &info->geometry;
    return filter_map_init(fine, g->nx, g->ny, info->oversample) &&
           (info->oversample == 1 || filter_map_init(coarse, g->nx, g->ny, 1));
}

static bool make_filter(shear_plan *plan) {
    const shear_plan_info *info = &plan->info;
    plan->filtered = info->filter != SHEAR_FILTER_NONE;
    if (!plan->filtered || info->filter_per_stamp)
        return true;
    if (!plan_init_filters(&plan->fine, &plan->coarse, info))
        return false;
    filter_map_fill(&plan->fine, info->core_px, info->width_px);
    if (info->oversample > 1)
        filter_map_fill(&plan->coarse, info->core_px, info->width_px);
    return true;
}

static bool make_high_band(shear_plan *plan) {
    const shear_geometry *g = &plan->info.geometry;
    const enum shear_noise_band band = plan->info.noise_band;
    return band == SHEAR_NOISE_BAND_NONE ||
           high_band_init(&plan->high, g->nx, g->ny, band == SHEAR_NOISE_BAND_CORNERS);
}

static bool make_plateau(shear_plan *plan) {
    const shear_geometry *g = &plan->info.geometry;
    return plan->settings.shot_noise != SHEAR_SHOT_PLATEAU ||
           plateau_init(&plan->plateau, g->nx, g->ny);
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory while planning");
}

/* Make the field's one transfer, with temporary scratch. */
static int make_transfer(shear_plan *plan, const double *psf, shear_error *err) {
    const shear_geometry *g = &plan->info.geometry;
    CLEANUP(transfer_scratch_deinit) transfer_scratch scratch = {0};
    if (!transfer_init(&plan->transfer, &plan->transfer_plan) ||
        !transfer_scratch_init(&scratch, &plan->transfer_plan)) {
        return out_of_memory(err);
    }
    TRY(transfer_make(&plan->transfer, &plan->transfer_plan, &scratch, psf, err));
    plan->has_psf = true;
    plan->info.k_cut = plan->transfer.k_cut;
    plan->flat = moments_of_flat(&plan->transfer_plan, &plan->transfer);
    plan->sharpness = sharpness_of(psf, g->psf_nx, g->psf_ny, g->psf_oversample);
    return SHEAR_OK;
}

/* With a PSF per stamp, only the grid's own limit can be checked here. */
static int check_limit(shear_plan *plan, shear_error *err) {
    const transfer_plan *p = &plan->transfer_plan;
    plan->info.k_cut = p->k_limit;
    if (transfer_power_beyond(p->beta_px, p->k_limit) > p->power_tolerance) {
        return shear_fail(
            err, SHEAR_E_BETA, "use a larger beta, or interpolate",
            "beta = %.4g px is too small for this sampling; the smallest that works is %.4f px",
            p->beta_px, transfer_smallest_beta(p->k_limit, p->power_tolerance));
    }
    return SHEAR_OK;
}

int shear_plan_new(shear_plan **out, const shear_plan_request *request, shear_error *err) {
    *out = NULL;
    CLEANUP(shear_plan_release) shear_plan *plan = calloc(1, sizeof *plan);
    if (plan == NULL)
        return out_of_memory(err);
    plan->settings = plan_settings(request);
    int psf_factor = 1;
    TRY(plan_resolve(&plan->info, &plan->settings, request, &psf_factor, err));
    if (!make_grids(plan, psf_factor) || !make_filter(plan) || !make_high_band(plan) ||
        !make_plateau(plan)) {
        return out_of_memory(err);
    }
    TRY(request->psf != NULL ? make_transfer(plan, request->psf, err) : check_limit(plan, err));
    shear_plan_note_psfs(plan, request->psfs, request->n_psfs, request->n_unusable);
    *out = CLEANUP_TAKE(plan);
    return SHEAR_OK;
}

int shear_plan_memory(shear_memory *memory, const shear_plan_request *request, shear_error *err) {
    const shear_settings settings = plan_settings(request);
    shear_plan_info info = {0};
    int psf_factor = 1;
    const int code = plan_resolve(&info, &settings, request, &psf_factor, err);
    const memory_of m = {.settings = &settings, .info = &info, .has_psf = request->psf != NULL};
    *memory = (shear_memory){0};
    if (code != SHEAR_OK)
        return code;
    memory->plan = memory_of_plan(&m);
    memory->planning = memory_of_planning(&m);
    memory->workspace = memory_of_workspace(&m, memory_last_row(&info));
    return SHEAR_OK;
}

static memory_of memory_of_made(const shear_plan *plan) {
    return (memory_of){.settings = &plan->settings, .info = &plan->info, .has_psf = plan->has_psf};
}

int64_t shear_plan_bytes(const shear_plan *plan) {
    const memory_of m = memory_of_made(plan);
    return memory_of_plan(&m);
}

int64_t shear_workspace_bytes(const shear_plan *plan) {
    const memory_of m = memory_of_made(plan);
    return memory_of_workspace(&m, plan->has_psf ? plan->transfer.jy : plan->transfer_plan.max_jy);
}

void shear_plan_free(shear_plan *plan) {
    if (plan == NULL)
        return;
    surface_grid_deinit(&plan->grid);
    fft_plan_free(plan->along_x);
    fft_plan_free(plan->along_y);
    transfer_plan_deinit(&plan->transfer_plan);
    transfer_deinit(&plan->transfer);
    filter_map_deinit(&plan->fine);
    filter_map_deinit(&plan->coarse);
    high_band_deinit(&plan->high);
    plateau_deinit(&plan->plateau);
    free(plan);
}

const char *shear_noise_band_name(enum shear_noise_band band) {
    static const char *const names[] = {"none", "high", "corners"};
    return band <= SHEAR_NOISE_BAND_CORNERS ? names[band] : "unknown";
}

void shear_plan_note_psfs(shear_plan *plan, const shear_psf_quality *each, int n, int unusable) {
    for (int i = 0; i < n; i++)
        shear_psf_summary_add(&plan->info.psf, &each[i], plan->info.beta_px);
    for (int i = 0; i < unusable; i++)
        shear_psf_summary_add(&plan->info.psf, NULL, plan->info.beta_px);
}

const shear_plan_info *shear_plan_get_info(const shear_plan *plan) {
    return &plan->info;
}

const shear_settings *shear_plan_get_settings(const shear_plan *plan) {
    return &plan->settings;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Make a plan, or compute the memory that it takes before it is made. */
#include "measure/internal.h"

#include "base/cleanup.h"
#include "common/release.h"

#include <stdlib.h>

/* A PSF made by FFTs has negative samples of this fraction of its peak; log methods treat them as
 * 0. */
static const double psf_rounding = 1e-4;

static void place_grids(shear_plan *plan, arena *a) {
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
    const int psf_factor = info->psf_oversample / g->psf_oversample;
    const enum shear_interpolation psf_method =
        psf_factor > 1 ? info->interpolation : SHEAR_INTERP_NONE;
    surface_grid_place(&plan->grid, g->nx, g->ny, info->interpolation, info->oversample, set->zeros,
                       set->pedestal, a);
    surface_grid_place(&tp->grid, g->psf_nx, g->psf_ny, psf_method, psf_factor, set->zeros, 0.0, a);
    tp->grid.rounding = psf_rounding;
    transfer_plan_place(tp, a);
    if (plan->has_psf)
        transfer_place(&plan->transfer, tp, a);
}

static void place_filter(shear_plan *plan, arena *a) {
    const shear_plan_info *info = &plan->info;
    if (info->filter == SHEAR_FILTER_NONE || info->filter_per_stamp)
        return;
    filter_pair_place(&plan->filter, info->geometry.nx, info->geometry.ny, info->oversample, a);
    if (a->memory != NULL)
        filter_pair_fill(&plan->filter, info->core_px, info->width_px);
}

/* Place the plan's tables, and fill all but the transfer unless the arena only counts. */
static void place(shear_plan *plan, arena *a) {
    const shear_geometry *g = &plan->info.geometry;
    const enum shear_noise_band band = plan->info.noise_band;
    place_grids(plan, a);
    place_filter(plan, a);
    if (band != SHEAR_NOISE_BAND_NONE)
        high_band_place(&plan->high, g->nx, g->ny, band == SHEAR_NOISE_BAND_CORNERS, a);
    if (plan->settings.shot_noise == SHEAR_SHOT_PLATEAU)
        plateau_place(&plan->plateau, g->nx, g->ny, a);
    plan->bytes = a->used;
}

/* Return false if out of memory. */
static bool make_tables(shear_plan *plan) {
    arena a = {0};
    place(plan, &a);
    plan->memory = arena_allocate(&a);
    if (plan->memory == NULL)
        return false;
    place(plan, &a);
    transfer_plan *tp = &plan->transfer_plan;
    plan->along_x = fft_plan_new(plan->info.fine_nx);
    plan->along_y = fft_plan_new(plan->info.fine_ny);
    tp->along_x = fft_plan_new(tp->period_nx);
    tp->along_y = fft_plan_new(tp->period_ny);
    return plan->along_x != NULL && plan->along_y != NULL && tp->along_x != NULL &&
           tp->along_y != NULL;
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory while planning");
}

/* Make the field's one transfer, with temporary scratch. */
static int make_transfer(shear_plan *plan, const double *psf, shear_error *err) {
    const shear_geometry *g = &plan->info.geometry;
    transfer_scratch scratch;
    arena a = {0};
    transfer_scratch_place(&scratch, &plan->transfer_plan, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    if (memory == NULL)
        return out_of_memory(err);
    transfer_scratch_place(&scratch, &plan->transfer_plan, &a);
    TRY(transfer_make(&plan->transfer, &plan->transfer_plan, &scratch, psf, err));
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
    TRY(plan_resolve(plan, request, err));
    if (!make_tables(plan))
        return out_of_memory(err);
    TRY(request->psf != NULL ? make_transfer(plan, request->psf, err) : check_limit(plan, err));
    shear_plan_note_psfs(plan, request->psfs, request->n_psfs, request->n_unusable);
    *out = CLEANUP_TAKE(plan);
    return SHEAR_OK;
}

int shear_plan_memory(shear_memory *memory, const shear_plan_request *request, shear_error *err) {
    shear_plan plan;
    *memory = (shear_memory){0};
    TRY(plan_resolve(&plan, request, err));
    transfer_scratch scratch;
    arena of_plan = {0};
    arena of_planning = {0};
    place(&plan, &of_plan);
    transfer_scratch_place(&scratch, &plan.transfer_plan, &of_planning);
    *memory = (shear_memory){.plan = shear_plan_bytes(&plan),
                             .planning = plan.has_psf ? (int64_t)of_planning.used : 0,
                             .workspace = shear_workspace_bytes(&plan)};
    return SHEAR_OK;
}

int64_t shear_plan_bytes(const shear_plan *plan) {
    const transfer_plan *tp = &plan->transfer_plan;
    return (int64_t)(sizeof *plan + plan->bytes + fft_plan_bytes(plan->info.fine_nx) +
                     fft_plan_bytes(plan->info.fine_ny) + fft_plan_bytes(tp->period_nx) +
                     fft_plan_bytes(tp->period_ny));
}

void shear_plan_free(shear_plan *plan) {
    if (plan == NULL)
        return;
    fft_plan_free(plan->along_x);
    fft_plan_free(plan->along_y);
    fft_plan_free(plan->transfer_plan.along_x);
    fft_plan_free(plan->transfer_plan.along_y);
    free(plan->memory);
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

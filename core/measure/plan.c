/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Make a plan, or compute the memory that it takes before it is made. */
#include "measure/internal.h"

#include "base/cleanup.h"
#include "common/release.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A PSF made by FFTs has negative samples of this fraction of its peak; log methods treat them as
 * 0. */
static const double psf_rounding = 1e-4;

/* Return k_limit over pi: the Nyquist circle of the fine grid or of the PSF's samples, if that is
 * smaller. Of models only modes that may count are kept, with a margin for pixels that are larger
 * than the median. */
static double side_of(const shear_plan *plan) {
    static const double margin = 1.3;
    const double side = fmin(plan->info.oversample, plan->psf_side);
    return plan->n_models == 0
               ? side
               : fmin(side, margin / M_PI *
                                target_farthest(plan->info.beta_px, plan->settings.psf_threshold));
}

/* Place the interpolation and transform of PSF images. */
static void place_psf_transform(shear_plan *plan, arena *a) {
    const shear_plan_info *info = &plan->info;
    const shear_settings *set = &plan->settings;
    const shear_geometry *g = &info->geometry;
    psf_transform *pt = &plan->psf_transform;
    const int factor = (int)lround(info->psf_oversample / g->psf_oversample);
    *pt = (psf_transform){.plane = plan->transfer_plan.plane,
                          .psf_nx = g->psf_nx,
                          .psf_ny = g->psf_ny,
                          .q = (int)lround(info->psf_oversample)};
    surface_grid_place(&pt->grid, g->psf_nx, g->psf_ny,
                       factor > 1 ? info->interpolation : SHEAR_INTERP_NONE, factor, set->zeros,
                       0.0, a);
    pt->grid.rounding = psf_rounding;
    psf_transform_set_sizes(pt);
}

static void place_waves(shear_plan *plan, arena *a) {
    const shear_geometry *g = &plan->info.geometry;
    const mode_plane *p = &plan->transfer_plan.plane;
    psf_waves_place(&plan->waves, p, g->psf_nx, g->psf_ny, a);
    if (a->memory != NULL)
        psf_waves_fill(&plan->waves, p, &(shear_psf_model){.step = 1.0 / g->psf_oversample});
}

/* Place a model: its tables, and a copy of its samples. */
static void place_model(plan_model *m, const mode_plane *p, const shear_psf_model *given,
                        arena *a) {
    const size_t samples = (size_t)given->terms * (size_t)given->nx * (size_t)given->ny;
    double *copy = arena_doubles(a, samples);
    if (copy != NULL)
        memcpy(copy, given->samples, samples * sizeof *copy);
    m->model = *given;
    m->model.samples = copy;
    if (given->axes == SHEAR_PSF_AXES_SKY) {
        psf_sky_place(&m->sky, &m->model, a);
    } else {
        psf_basis_place(&m->basis, p, given->terms, given->axes == SHEAR_PSF_AXES_MODES ? 1 : 2, a);
    }
}

static void place_models(shear_plan *plan, const shear_psf_model *models, arena *a) {
    plan_model counted;
    plan->models = arena_take(a, (size_t)plan->n_models * sizeof *plan->models);
    for (int i = 0; i < plan->n_models; i++) {
        plan_model *m = plan->models != NULL ? &plan->models[i] : &counted;
        place_model(m, &plan->transfer_plan.plane, &models[i], a);
    }
}

static void place_psfs(shear_plan *plan, const shear_psf_model *models, arena *a) {
    if (plan->n_models > 0) {
        place_models(plan, models, a);
    } else if (plan->by_fft) {
        place_psf_transform(plan, a);
    } else {
        place_waves(plan, a);
    }
}

static void place_transfers(shear_plan *plan, const shear_psf_model *models, arena *a) {
    const shear_plan_info *info = &plan->info;
    const shear_settings *set = &plan->settings;
    transfer_plan *tp = &plan->transfer_plan;
    *tp =
        (transfer_plan){.plane = mode_plane_of(info->geometry.nx, info->geometry.ny, side_of(plan)),
                        .s = info->oversample,
                        .threshold = set->psf_threshold,
                        .power_tolerance = set->power_tolerance,
                        .farthest = target_farthest(info->beta, set->psf_threshold)};
    target_place(&tp->target, &tp->plane, a);
    if (a->memory != NULL)
        target_fill(&tp->target, &tp->plane, info->beta_px, tp->s);
    place_psfs(plan, models, a);
    if (plan->has_psf) {
        plan->power = arena_doubles(a, tp->plane.size);
        transfer_place(&plan->transfer, &tp->plane, a);
    }
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
static void place(shear_plan *plan, const shear_psf_model *models, arena *a) {
    const shear_geometry *g = &plan->info.geometry;
    const enum shear_noise_band band = plan->info.noise_band;
    surface_grid_place(&plan->grid, g->nx, g->ny, plan->info.interpolation, plan->info.oversample,
                       plan->settings.zeros, plan->settings.pedestal, a);
    place_transfers(plan, models, a);
    place_filter(plan, a);
    if (band != SHEAR_NOISE_BAND_NONE)
        high_band_place(&plan->high, g->nx, g->ny, band == SHEAR_NOISE_BAND_CORNERS, a);
    if (plan->settings.shot_noise == SHEAR_SHOT_PLATEAU)
        plateau_place(&plan->plateau, g->nx, g->ny, a);
    plan->bytes = a->used;
}

/* Return false if out of memory. */
static bool make_ffts(shear_plan *plan) {
    psf_transform *pt = &plan->psf_transform;
    plan->along_x = fft_plan_new(plan->info.fine_nx);
    plan->along_y = fft_plan_new(plan->info.fine_ny);
    if (!plan->by_fft)
        return plan->along_x != NULL && plan->along_y != NULL;
    pt->along_x = fft_plan_new(pt->period_nx);
    pt->along_y = fft_plan_new(pt->period_ny);
    return plan->along_x != NULL && plan->along_y != NULL && pt->along_x != NULL &&
           pt->along_y != NULL;
}

/* Return false if out of memory. */
static bool make_tables(shear_plan *plan, const shear_psf_model *models) {
    arena a = {0};
    place(plan, models, &a);
    plan->memory = arena_allocate(&a);
    if (plan->memory == NULL)
        return false;
    place(plan, models, &a);
    return make_ffts(plan);
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory while planning");
}

/* Scratch for the transform of an image. */
typedef struct image_scratch {
    psf_scratch by_fft;
    psf_direct direct;
} image_scratch;

static void image_scratch_place(image_scratch *s, const shear_plan *plan, arena *a) {
    if (plan->by_fft) {
        psf_scratch_place(&s->by_fft, &plan->psf_transform, a);
    } else {
        psf_direct_place(&s->direct, &plan->transfer_plan.plane, &plan->waves, a);
    }
}

/* Make the transfer of the field's one PSF in the pixel frame, with temporary scratch. In a frame
 * on the sky it only shows whether beta is large enough. */
static int make_transfer(shear_plan *plan, const double *psf, shear_error *err) {
    const shear_geometry *g = &plan->info.geometry;
    const transfer_plan *tp = &plan->transfer_plan;
    image_scratch scratch;
    arena a = {0};
    image_scratch_place(&scratch, plan, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    if (memory == NULL)
        return out_of_memory(err);
    image_scratch_place(&scratch, plan, &a);
    TRY(plan->by_fft
            ? psf_transform_power(&plan->psf_transform, &scratch.by_fft, psf, plan->power, err)
            : psf_direct_power(&scratch.direct, &tp->plane, &plan->waves, &tp->target.aim, psf,
                               plan->power, err));
    TRY(transfer_make(&plan->transfer, tp, plan->power, err));
    plan_note_transfer(plan, &plan->transfer);
    plan->flat = moments_of_flat(&tp->plane, &plan->transfer);
    plan->sharpness = sharpness_of(psf, g->psf_nx, g->psf_ny, g->psf_oversample);
    plan->suspicious = plan->sharpness;
    return SHEAR_OK;
}

/* With a PSF per stamp, only the grid's own limit can be checked here. */
static int check_limit(shear_plan *plan, shear_error *err) {
    plan->suspicious = (sharpness){.ratio = 1.0, .leak = 0.0}; /* the weakest bound there is */
    const double limit = plan->transfer_plan.plane.k_limit;
    const double beta_px = plan->info.beta_px;
    const double tolerance = plan->settings.power_tolerance;
    plan->info.k_cut = limit;
    if (transfer_power_beyond(beta_px, limit) > tolerance) {
        return shear_fail(
            err, SHEAR_E_BETA, "use a larger beta, or interpolate",
            "beta = %.4g px is too small for this sampling; the smallest that works is %.4f px",
            beta_px, transfer_smallest_beta(limit, tolerance));
    }
    return SHEAR_OK;
}

int shear_plan_new(shear_plan **out, const shear_plan_request *request, shear_error *err) {
    *out = NULL;
    CLEANUP(shear_plan_release) shear_plan *plan = calloc(1, sizeof *plan);
    if (plan == NULL)
        return out_of_memory(err);
    TRY(plan_resolve(plan, request, err));
    if (!make_tables(plan, request->models))
        return out_of_memory(err);
    TRY(plan->has_psf ? make_transfer(plan, request->psf, err) : check_limit(plan, err));
    if (plan->n_models > 0)
        TRY(plan_models_fill(plan, request, err));
    plan->info.centring = request->centring;
    shear_plan_note_psfs(plan, request->psfs, request->n_psfs, request->n_unusable);
    *out = CLEANUP_TAKE(plan);
    return SHEAR_OK;
}

int shear_plan_memory(shear_memory *memory, const shear_plan_request *request, shear_error *err) {
    shear_plan plan;
    *memory = (shear_memory){0};
    TRY(plan_resolve(&plan, request, err));
    image_scratch scratch;
    arena of_plan = {0};
    arena of_planning = {0};
    place(&plan, request->models, &of_plan);
    if (plan.has_psf)
        image_scratch_place(&scratch, &plan, &of_planning);
    if (plan.n_models > 0)
        plan_models_scratch(&plan, request, &of_planning);
    *memory = (shear_memory){.plan = shear_plan_bytes(&plan),
                             .planning = (int64_t)of_planning.used,
                             .workspace = shear_workspace_bytes(&plan)};
    return SHEAR_OK;
}

int64_t shear_plan_bytes(const shear_plan *plan) {
    const psf_transform *pt = &plan->psf_transform;
    const size_t psf =
        plan->by_fft ? fft_plan_bytes(pt->period_nx) + fft_plan_bytes(pt->period_ny) : 0;
    return (int64_t)(sizeof *plan + plan->bytes + fft_plan_bytes(plan->info.fine_nx) +
                     fft_plan_bytes(plan->info.fine_ny) + psf);
}

void shear_plan_free(shear_plan *plan) {
    if (plan == NULL)
        return;
    fft_plan_free(plan->along_x);
    fft_plan_free(plan->along_y);
    fft_plan_free(plan->psf_transform.along_x);
    fft_plan_free(plan->psf_transform.along_y);
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

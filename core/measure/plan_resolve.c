/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolve what the settings leave open, from the geometry, the PSF and the galaxies. */
#include "measure/filter.h"

#include "base/cleanup.h"
#include "measure/internal.h"
#include "measure/psf_model.h"

#include <math.h>

/* A packed fine image of more points would need over a gigabyte per thread. */
static const double max_fine_points = 67108864.0;
/* A PSF of this radius (in samples) is well sampled (docs/method.md, section 1). */
static const double well_sampled_px = 1.0;
/* For a narrower PSF, the aliasing by pixels is negligible under a target of at least this beta
 * (docs/method.md, section 1). */
static const double aliases_vanish_px = 1.2;
/* With such a PSF galaxies have no power beyond 3/4 of Nyquist (docs/method.md, section 5). */
static const double smooth_px = 1.3;

static int check_geometry(const shear_geometry *g, bool has_images, shear_error *err) {
    if (g->nx < SHEAR_MIN_SIDE || g->ny < SHEAR_MIN_SIDE || g->nx > SHEAR_MAX_SIDE ||
        g->ny > SHEAR_MAX_SIDE) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "stamps of %d x %d px: each side must be %d to %d px", g->nx, g->ny,
                          SHEAR_MIN_SIDE, SHEAR_MAX_SIDE);
    }
    if (!has_images)
        return SHEAR_OK;
    if (g->psf_nx < 2 || g->psf_ny < 2 || !(g->psf_oversample >= SHEAR_MIN_PSF_OVERSAMPLE)) {
        return shear_fail(err, SHEAR_E_PSF, NULL,
                          "a PSF of %d x %d samples, %g per pixel: too small", g->psf_nx, g->psf_ny,
                          g->psf_oversample);
    }
    return SHEAR_OK;
}

/* Check that the PSF's fine image and its transform fit, too; this also keeps nx q far from
 * overflow. */
static int check_psf_size(const shear_plan_info *info, shear_error *err) {
    const shear_geometry *g = &info->geometry;
    const double factor = info->psf_oversample / g->psf_oversample;
    const double q = info->psf_oversample;
    const double samples = (double)g->psf_nx * factor * g->psf_ny * factor;
    const double modes = 0.5 * g->nx * fmin(q, info->oversample) * g->ny * q;
    if (modes > max_fine_points || (factor > 1 && samples > max_fine_points)) {
        return shear_fail(
            err, SHEAR_E_PSF,
            "give a PSF of fewer samples, or with fewer samples per pixel (OVERSAMP)",
            "a PSF of %d x %d samples, %g per pixel, is too large for stamps of %d x %d px",
            g->psf_nx, g->psf_ny, g->psf_oversample, g->nx, g->ny);
    }
    return SHEAR_OK;
}

/* Return the smallest power of two with 1/s < r/4. */
static int finest_needed(double r_psf_px) {
    int s = 1;
    while (1.0 / s >= r_psf_px / 4.0 && s < 1024)
        s *= 2;
    return s;
}

/* Choose an interpolation by rule. An explicit beta that is too small for the pixels causes
 * interpolation, like an explicit s or pedestal. */
static enum shear_interpolation choose_interpolation(const shear_settings *set,
                                                     const shear_plan_info *info) {
    const double r = info->r_psf_px;
    const bool asked = set->oversample > 1 || set->pedestal > 0;
    const bool blurred =
        set->interpolation == SHEAR_INTERP_AUTO && info->beta_px >= aliases_vanish_px;
    return !asked && (r >= well_sampled_px || blurred) ? SHEAR_INTERP_NONE
                                                       : SHEAR_INTERP_LOG_BICUBIC;
}

/* Resolve interpolation and s. */
static int resolve_sampling(const shear_settings *set, shear_plan_info *info, shear_error *err) {
    const double r = info->r_psf_px;
    info->interpolation = set->interpolation;
    if (shear_interpolation_is_rule(set->interpolation))
        info->interpolation = choose_interpolation(set, info);
    const bool none = info->interpolation == SHEAR_INTERP_NONE;
    if (!none && set->shot_noise == SHEAR_SHOT_PLATEAU) {
        return shear_fail(err, SHEAR_E_SETTING, "set interpolation=none, or shot-noise=none",
                          "shot-noise=plateau goes without interpolation, but R_PSF is %.3g px and "
                          "interpolation=%s takes %s",
                          r, shear_interpolation_name(set->interpolation),
                          shear_interpolation_name(info->interpolation));
    }
    info->oversample = none ? 1 : set->oversample > 0 ? set->oversample : finest_needed(r);
    info->fine_nx = info->geometry.nx * info->oversample;
    info->fine_ny = info->geometry.ny * info->oversample;
    if ((double)info->fine_nx * info->fine_ny > max_fine_points) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "set oversample to a smaller number, or cut smaller stamps",
                          "a fine grid of %d x %d points (oversample %d) is too large",
                          info->fine_nx, info->fine_ny, info->oversample);
    }
    return SHEAR_OK;
}

/* Resolve the PSF's sampling: finer than as given where the stamps are interpolated, too. A PSF
 * that is sampled finer than the pixels is used as it is, if its samples are no further apart than
 * its radius; so is one without a whole number of samples per pixel. */
static int resolve_psf_sampling(shear_plan_info *info, shear_error *err) {
    const bool none = info->interpolation == SHEAR_INTERP_NONE;
    const double given = info->geometry.psf_oversample;
    const bool fine_enough =
        given != floor(given) || (given > 1 && info->r_psf_px * given >= well_sampled_px);
    info->psf_oversample = given;
    while (!none && !fine_enough && info->psf_oversample < info->oversample)
        info->psf_oversample *= 2;
    return check_psf_size(info, err);
}

/* Return the settings of the request, or the defaults. */
static shear_settings settings_of(const shear_plan_request *request) {
    shear_settings settings;
    if (request->settings != NULL)
        return *request->settings;
    shear_settings_init(&settings);
    return settings;
}

static bool wants_core(const shear_settings *set, const shear_plan_request *request) {
    return set->filter == SHEAR_FILTER_AUTO && isnan(set->core_px) && !request->has_r_gal;
}

bool shear_plan_wants_core(const shear_plan_request *request) {
    const shear_settings settings = settings_of(request);
    return wants_core(&settings, request);
}

static double width_of(const shear_settings *set, enum shear_filter filter, double beta_px) {
    return !isnan(set->width_px)         ? set->width_px
           : filter == SHEAR_FILTER_EDGE ? 0.5 * beta_px
                                         : beta_px;
}

static int resolve_filter(const shear_settings *set, shear_plan_info *info,
                          const shear_plan_request *request, shear_error *err) {
    const bool has_r_gal = request->has_r_gal;
    const bool found = wants_core(set, request) && request->core_px > 0.0;
    const double core = found ? request->core_px : set->core_px;
    const bool core_given = !isnan(core);
    info->filter = set->filter;
    if (set->filter == SHEAR_FILTER_AUTO || set->filter == SHEAR_FILTER_R_GAL)
        info->filter = core_given || has_r_gal ? SHEAR_FILTER_PAPER : SHEAR_FILTER_NONE;
    info->core_px = NAN;
    info->width_px = NAN;
    info->filter_per_stamp = info->filter == SHEAR_FILTER_PAPER && !core_given;
    if (info->filter == SHEAR_FILTER_NONE)
        return SHEAR_OK;
    if (info->filter_per_stamp && !has_r_gal) {
        return shear_fail(
            err, SHEAR_E_SETTING, "add the column R_GAL, or give a core, or use filter=none",
            "filter=paper needs R_G of the galaxies, and there is no column R_GAL in CATALOG");
    }
    const bool edge = info->filter == SHEAR_FILTER_EDGE;
    info->width_px = width_of(set, info->filter, info->beta_px);
    info->core_px = core;
    info->core_found = found;
    if (edge) {
        info->core_px = filter_edge_core(info->geometry.nx, info->geometry.ny, info->width_px);
        if (!(info->core_px > 0.0)) {
            return shear_fail(
                err, SHEAR_E_SETTING, "set a smaller width, or cut larger stamps",
                "filter=edge: a fall of width %.3g px does not fit into stamps of %d x %d px",
                info->width_px, info->geometry.nx, info->geometry.ny);
        }
    }
    return SHEAR_OK;
}

static enum shear_noise_band resolve_noise_band(const shear_settings *set,
                                                const shear_plan_info *info) {
    const bool wanted = set->noise_level == SHEAR_NOISE_LEVEL_FIELD && set->noise_correction &&
                        set->shot_noise == SHEAR_SHOT_NONE;
    if (!wanted || info->interpolation != SHEAR_INTERP_NONE || info->r_psf_px < well_sampled_px)
        return SHEAR_NOISE_BAND_NONE;
    return info->r_psf_px >= smooth_px ? SHEAR_NOISE_BAND_HIGH : SHEAR_NOISE_BAND_CORNERS;
}

/* Resolve R_PSF and beta. */
static int resolve_radii(const shear_settings *set, shear_plan_info *info,
                         const shear_plan_request *request, shear_error *err) {
    const shear_geometry *g = &request->geometry;
    shear_psf_quality quality = {.r_psf_px = request->r_psf_px};
    const int code = request->psf == NULL ? SHEAR_OK
                                          : shear_psf_examine(&quality, request->psf, g->psf_nx,
                                                              g->psf_ny, g->psf_oversample, err);
    info->r_psf_px = quality.r_psf_px;
    if (code != SHEAR_OK)
        return code;
    if (!(info->r_psf_px > 0.0) || !isfinite(info->r_psf_px)) {
        return shear_fail(err, SHEAR_E_PSF, NULL, "the PSF's scale radius is %g px",
                          info->r_psf_px);
    }
    info->beta_px = !isnan(set->beta_px)
                        ? set->beta_px
                        : fmax(set->beta_ratio * info->r_psf_px, set->beta_floor_px);
    if (request->psf != NULL)
        shear_psf_summary_add(&info->psf, &quality, info->beta_px);
    return SHEAR_OK;
}

/* Resolve the frame and its unit. */
static int resolve_frame(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    const bool pixel = request->frame == SHEAR_FRAME_PIXEL;
    const double unit = pixel ? 1.0 : request->pixel_scale;
    if (!(unit > 0.0) || !isfinite(unit)) {
        return shear_fail(err, SHEAR_E_FORMAT, "give pixel_scale, arcsec per pixel",
                          "a plan of frame %s needs the scale of the pixels, which is %g",
                          shear_frame_name(request->frame), unit);
    }
    plan->info.frame = request->frame;
    plan->needs_jacobians = !pixel;
    plan->pixel_scale = request->pixel_scale;
    plan->unit = unit;
    plan->info.beta = plan->info.beta_px * unit;
    plan->r_psf = plan->info.r_psf_px * unit;
    plan->has_transfer = plan->has_psf && pixel;
    return SHEAR_OK;
}

/* Return what is wrong with a model, or NULL. */
static const char *model_fault(const shear_psf_model *m, int terms, const shear_geometry *g) {
    const bool modes = m->axes == SHEAR_PSF_AXES_MODES;
    return m->terms != terms || terms < 1 || terms > SHEAR_MAX_PSF_TERMS ? "number of terms"
           : m->nx < 1 || m->nx > SHEAR_MAX_PSF_SIDE || m->ny < 1 || m->ny > SHEAR_MAX_PSF_SIDE ||
                   (modes && (m->nx != g->nx || m->ny != g->ny))
               ? "size of its planes"
           : !modes && (!(m->step > 0.0) || !isfinite(m->step)) ? "step"
           : m->lanczos < 0 || m->lanczos > 32                  ? "order of the Lanczos kernel"
           : !(m->smoothed_px >= 0.0 && m->smoothed_px <= SHEAR_MAX_PSF_SIDE) ||
                   (m->smoothed_px > 0.0 && m->axes != SHEAR_PSF_AXES_PIXEL)
               ? "smoothing"
               : NULL;
}

/* Check the models, and find the coarsest of their samplings. */
static int resolve_models(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    plan->n_models = request->n_models;
    plan->psf_side = INFINITY;
    for (int i = 0; i < request->n_models; i++) {
        const shear_psf_model *m = &request->models[i];
        const char *fault = model_fault(m, request->models[0].terms, &request->geometry);
        const double side = psf_model_sampling(m, plan->pixel_scale);
        if (fault == NULL && (!(side > SHEAR_MIN_PSF_OVERSAMPLE) || !isfinite(side)))
            fault = "step";
        if (fault != NULL)
            return shear_fail(err, SHEAR_E_PSF, NULL, "PSF model %d: impossible %s", i, fault);
        plan->psf_side = fmin(plan->psf_side, side);
        plan->needs_jacobians = plan->needs_jacobians || m->axes == SHEAR_PSF_AXES_SKY;
        plan->model_nx = m->nx > plan->model_nx ? m->nx : plan->model_nx;
        plan->model_ny = m->ny > plan->model_ny ? m->ny : plan->model_ny;
    }
    plan->info.psf_oversample = plan->psf_side;
    return request->terms == NULL || (request->model >= 0 && request->model < request->n_models)
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_PSF, NULL, "there is no PSF model %d", request->model);
}

static int resolve_psfs(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    if (request->n_models > 0)
        return resolve_models(plan, request, err);
    TRY(resolve_psf_sampling(&plan->info, err));
    plan->psf_side = plan->info.psf_oversample;
    plan->by_fft = plan->psf_side == floor(plan->psf_side);
    return SHEAR_OK;
}

int plan_resolve(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    const shear_settings *set = &plan->settings;
    shear_plan_info *info = &plan->info;
    *plan = (shear_plan){.settings = settings_of(request),
                         .info = {.geometry = request->geometry},
                         .has_psf = request->psf != NULL};
    TRY(shear_settings_check(set, err));
    TRY(check_geometry(&info->geometry, request->n_models == 0, err));
    TRY(resolve_radii(set, info, request, err));
    TRY(resolve_frame(plan, request, err));
    TRY(resolve_sampling(set, info, err));
    TRY(resolve_psfs(plan, request, err));
    info->noise_band = resolve_noise_band(set, info);
    return resolve_filter(set, info, request, err);
}

int shear_plan_find_radii(shear_plan_radii *radii, const shear_plan_request *request,
                          shear_error *err) {
    const shear_settings settings = settings_of(request);
    shear_plan_info info = {.geometry = request->geometry};
    const int code = resolve_radii(&settings, &info, request, err);
    *radii = (shear_plan_radii){.r_psf_px = info.r_psf_px,
                                .beta_px = info.beta_px,
                                .width_px = width_of(&settings, settings.filter, info.beta_px)};
    return code;
}

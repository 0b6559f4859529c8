/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure one stamp pair, from pixels to its row: flags, transform, moments, terms. */
#include "measure/artefact.h"

#include "base/cleanup.h"
#include "measure/internal.h"
#include "measure/photometry.h"
#include "measure/psf_model.h"
#include "measure/row.h"
#include "measure/saturation.h"
#include "measure/spectra.h"

#include <math.h>

stamp_pair measure_pair_at(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                           int i) {
    const size_t pixels = (size_t)stamps->nx * (size_t)stamps->ny;
    const int planes = stamps->noise_planes > 1 ? stamps->noise_planes : 1;
    return (stamp_pair){.plan = plan,
                        .ws = ws,
                        .stamps = stamps,
                        .i = i,
                        .galaxy = stamps->galaxy + (size_t)i * pixels,
                        .noise = stamps->noise + (size_t)i * (size_t)planes * pixels,
                        .pixels = pixels,
                        .planes = planes};
}

void measure_choose_filter(stamp_pair *s, uint32_t *flags) {
    const shear_plan_info *info = &s->plan->info;
    if (!info->filter_per_stamp) {
        s->filter = info->filter != SHEAR_FILTER_NONE ? &s->plan->filter : NULL;
        return;
    }
    const double r_gal = s->stamps->r_gal != NULL ? s->stamps->r_gal[s->i] : NAN;
    if (!(r_gal > 0.0) || !isfinite(r_gal)) {
        *flags |= SHEAR_FLAG_BAD_R_GAL;
        return;
    }
    const double core = r_gal + 4.0 * info->beta_px; /* Zhang (2010), section 4.2 */
    filter_pair_fill(&s->ws->filter, core, info->width_px);
    s->filter = &s->ws->filter;
}

static int negative_pixel(const stamp_pair *s, shear_error *err) {
    const pack_failure *where = &s->failure;
    return shear_fail(
        err, SHEAR_E_NEGATIVE,
        "give a pedestal above the most negative pixel, or an interpolation that is not "
        "logarithmic",
        "%s stamp %lld (from 0) is negative at pixel (%d, %d), and %s takes logarithms",
        where->in_noise ? "noise" : "galaxy", (long long)s->stamps->first + s->i, where->x + 1,
        where->y + 1, shear_interpolation_name(s->plan->info.interpolation));
}

static uint32_t flag_if(bool set, enum shear_flag flag) {
    return set ? (uint32_t)flag : 0u;
}

/* Return the flux that the filter removes. If the fine grid is that of the pixels, it is what the
 * transform lost of its k = 0, except for the two levels that were subtracted (those of the pair
 * packed last, so not with several noise stamps). */
static double removed_flux(const stamp_pair *s, double lost) {
    if (s->filter == NULL)
        return 0.0;
    const filter_map *filter = filter_pair_pixels(s->filter);
    return s->plan->info.oversample == 1 && s->plan->settings.noise_correction && s->planes == 1
               ? lost + (s->ws->noise_level - s->ws->level) * filter->sum
               : photometry_removed(filter->value, s->galaxy, s->noise, s->pixels);
}

static photometry look(const stamp_pair *s, const double *galaxy, const double *noise) {
    return photometry_of(galaxy, noise, s->stamps->nx, s->stamps->ny, s->ws->strip_most);
}

/* Return the flags of the pixels, whose photometry is known. */
static uint32_t flags_of_pixels(const stamp_pair *s) {
    const photometry *ph = &s->ph;
    const double bad = s->plan->settings.bad_value;
    const bool galaxy_bad = !isnan(bad) && photometry_holds(s->galaxy, s->pixels, bad);
    const bool noise_bad =
        !isnan(bad) && photometry_holds(s->noise, (size_t)s->planes * s->pixels, bad);
    return flag_if(!ph->galaxy_finite || galaxy_bad, SHEAR_FLAG_GALAXY_NOT_FINITE) |
           flag_if(!ph->noise_finite || noise_bad, SHEAR_FLAG_NOISE_NOT_FINITE) |
           flag_if(ph->galaxy_finite && ph->galaxy_flat, SHEAR_FLAG_EMPTY);
}

/* Do everything up to the transform along y, including the photometry. Bad pixels are found on the
 * way; then what was packed is not used. */
static void prepare(stamp_pair *s, uint32_t *flags) {
    uint32_t psf_flag = 0;
    measure_choose_filter(s, flags);
    if (*flags == 0)
        pair_transfer_choose(s, &psf_flag);
    if (s->transfer != NULL) {
        s->packed = pack_pair(s->plan, s->ws, s->filter, s->galaxy, s->noise, false, s->transfer,
                              &s->ph, &s->failure);
    } else {
        s->ph = look(s, s->galaxy, s->noise);
    }
    *flags |= flags_of_pixels(s);
    *flags |= *flags == 0 ? psf_flag : 0u;
}

/* Return the sharpness of the pair's model; NULL if it has none. */
static const sharpness *sharpness_of_model(const stamp_pair *s) {
    const double *terms;
    const int i = pair_transfer_model(s, &terms);
    if (i < 0)
        return NULL;
    const shear_psf_model *m = &s->plan->models[i].model;
    const psf_view image = {.psf = s->ws->psf_sky.image, .nx = m->nx, .ny = m->ny};
    const bool sky = m->axes == SHEAR_PSF_AXES_SKY;
    const double *j = sky ? s->stamps->jacobian + 4 * (size_t)s->i : NULL;
    const double x[2] = {(sky ? j[0] : 1.0) / m->step, sky ? j[2] / m->step : 0.0};
    const double y[2] = {sky ? j[1] / m->step : 0.0, (sky ? j[3] : 1.0) / m->step};
    if (m->axes == SHEAR_PSF_AXES_MODES)
        return s->plan->sharpness.ratio > 0.0 ? &s->plan->sharpness : NULL;
    psf_model_sum(m->samples, m->terms, (size_t)m->nx * (size_t)m->ny, terms, s->ws->psf_sky.image);
    s->ws->sharpness = sharpness_on_pixels(&image, x, y);
    return &s->ws->sharpness;
}

/* Return the PSF's sharpness, or NULL if the pair has no PSF. For a PSF per stamp it is computed on
 * request only, because it is slow. */
static const sharpness *choose_sharpness(const stamp_pair *s) {
    const shear_geometry *g = &s->plan->info.geometry;
    if (s->plan->has_psf)
        return &s->plan->sharpness;
    if (s->plan->n_models > 0)
        return sharpness_of_model(s);
    const double *psf = pair_transfer_image(s);
    if (psf == NULL)
        return NULL;
    if (psf != s->ws->sharpness_of) {
        s->ws->sharpness = sharpness_of(psf, g->psf_nx, g->psf_ny, g->psf_oversample);
        s->ws->sharpness_of = psf;
    }
    return &s->ws->sharpness;
}

/* Find an artefact or a flat top in two images whose pixels are finite, the pair's or two of its
 * noise stamps. */
static void find_artefact(const stamp_pair *s, const double *galaxy, const double *noise,
                          const photometry *ph, shear_row *row) {
    const artefact_pair pair = {.galaxy = galaxy,
                                .noise = noise,
                                .nx = s->stamps->nx,
                                .ny = s->stamps->ny,
                                .ph = ph,
                                .strip_most = s->ws->strip_most};
    artefact found = {.x = -1, .y = -1};
    if (s->plan->settings.artefacts == SHEAR_ARTEFACTS_KEEP)
        return;
    if (artefact_suspected(&pair, &s->plan->suspicious)) {
        const sharpness *sharp = choose_sharpness(s);
        found = sharp != NULL ? artefact_find(&pair, sharp) : found;
    }
    const double sigma = artefact_sigma(&pair);
    if (found.x < 0 && saturation_suspected(&pair, sigma))
        found = saturation_find(&pair, sigma);
    if (found.x >= 0) {
        row->flags |= found.in_noise ? SHEAR_FLAG_NOISE_ARTEFACT : SHEAR_FLAG_ARTEFACT;
        row->artefact_x = found.x;
        row->artefact_y = found.y;
    }
}

/* Set the flags that two further noise stamps, with photometry `ph`, give the row. */
static void check_more_noise(const stamp_pair *s, const double *one, const double *two,
                             const photometry *ph, shear_row *row) {
    shear_row seen = {.artefact_x = -1, .artefact_y = -1};
    if (!ph->galaxy_finite || !ph->noise_finite) {
        row->flags |= SHEAR_FLAG_NOISE_NOT_FINITE;
        return;
    }
    find_artefact(s, one, two, ph, &seen);
    if (seen.flags != 0) {
        row->flags |= SHEAR_FLAG_NOISE_ARTEFACT;
        row->artefact_x = seen.artefact_x;
        row->artefact_y = seen.artefact_y;
    }
}

/* Return whether a noise stamp with pixels from `least` to `most` varies by more than rounding. */
static bool holds_noise(const stamp_pair *s, const double *noise, double least, double most) {
    return most > least &&
           !photometry_is_rounding(noise, s->pixels, least, most, s->ph.galaxy_most);
}

/* Add two further noise stamps to the sum of all. Return false if they cannot be used: they flag
 * the row, or are negative under a log method (`s->packed` is false). */
static bool add_noise(stamp_pair *s, const double *one, const double *two, spectra *all,
                      shear_row *row) {
    photometry ph;
    if (s->plan->settings.noise_correction) {
        s->packed =
            pack_pair(s->plan, s->ws, s->filter, one, two, true, s->transfer, &ph, &s->failure);
        s->failure.in_noise = true;
    } else {
        ph = look(s, one, two);
    }
    check_more_noise(s, one, two, &ph, row);
    if (!s->packed || row->flags != 0)
        return false;
    s->noisy = s->noisy || holds_noise(s, one, ph.galaxy_least, ph.galaxy_most) ||
               holds_noise(s, two, ph.noise_least, ph.noise_most);
    if (s->plan->settings.noise_correction) {
        const spectra pair = spectra_of(s->plan, s->ws, s->transfer);
        spectra_add_noise(all, &pair, one == two ? 0.5 : 1.0);
    }
    return true;
}

/* Add the noise stamps after the first, two per transform, and replace the first one's noise by the
 * mean of all. Return false if one cannot be used, as above. */
static bool more_noise(stamp_pair *s, spectra *sp, shear_row *row) {
    spectra all = *sp;
    for (int k = 1; k < s->planes; k += 2) {
        const double *one = s->noise + (size_t)k * s->pixels;
        const double *two =
            k + 1 < s->planes ? one + s->pixels : one; /* the last one twice, halved */
        if (!add_noise(s, one, two, &all, row))
            return false;
    }
    if (s->planes > 1)
        spectra_set_noise(sp, &all, s->planes);
    return true;
}

/* Begin the row with the flags of the catalog and of the reader. Return false if the reader has
 * found a reason to leave it out; then the pixels mean nothing. */
static bool begin_row(const stamp_pair *s, shear_row *row) {
    const shear_stamps *stamps = s->stamps;
    const uint32_t found = stamps->flags != NULL ? stamps->flags[s->i] : 0;
    const double weight = stamps->weight != NULL ? stamps->weight[s->i] : 1.0;
    const bool masked = stamps->mask != NULL && stamps->mask[s->i] != 0;
    row_init(row, stamps->first + s->i, weight, s->plan->info.frame,
             found | flag_if(masked, SHEAR_FLAG_MASKED) |
                 flag_if(!shear_weight_is_good(weight), SHEAR_FLAG_BAD_WEIGHT));
    return found == 0;
}

/* Take the sums over modes to the frame of the moments. */
static void take_to_frame(const stamp_pair *s, spectra *sp) {
    const frame_map *map = &s->ws->aim.map;
    if (s->plan->info.frame == SHEAR_FRAME_PIXEL)
        return;
    moments_take_to_frame(&sp->difference, map);
    moments_take_to_frame(&sp->noise, map);
    moments_take_to_frame(&sp->cross, map);
}

/* Return the pixels of which the filter leaves the noise. */
static double noise_area(const stamp_pair *s) {
    return s->filter != NULL ? filter_pair_pixels(s->filter)->sum : (double)s->pixels;
}

static int measure_one(stamp_pair *s, shear_row *row, shear_error *err) {
    const shear_plan *plan = s->plan;
    if (!begin_row(s, row))
        return SHEAR_OK;
    prepare(s, &row->flags);
    if (row->flags == 0)
        find_artefact(s, s->galaxy, s->noise, &s->ph, row);
    if (row->flags != 0)
        return SHEAR_OK;
    if (!s->packed)
        return negative_pixel(s, err);
    spectra sp = spectra_of(plan, s->ws, s->transfer);
    s->noisy = holds_noise(s, s->noise, s->ph.noise_least, s->ph.noise_most);
    if (!more_noise(s, &sp, row))
        return row->flags != 0 ? SHEAR_OK : negative_pixel(s, err);
    row_fill_photometry(row, s->stamps, s->galaxy, s->noise, &s->ph);
    row->flux_removed = removed_flux(s, s->ph.flux - sp.flux);
    spectra_subtract_plateau(&sp, plan, s->transfer);
    if (!s->noisy)
        spectra_forget_noise(&sp);
    take_to_frame(s, &sp);
    row_fill_noise(row, &sp, plan);
    row_fill_d_err(row, &sp, plan, noise_area(s));
    if (plan->settings.estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS)
        row_fill_cross(row, &sp.cross, plan->info.beta, plan->r_psf);
    row_fill_moments(row, &sp.difference, plan->info.beta);
    return SHEAR_OK;
}

static int check_stamps(const shear_plan *plan, const shear_stamps *stamps, shear_error *err) {
    const shear_geometry *g = &plan->info.geometry;
    if ((plan->n_models > 0 && stamps->psf_terms == NULL) ||
        (plan->needs_jacobians && stamps->jacobian == NULL)) {
        return shear_fail(err, SHEAR_E_INTERNAL, "give psf_terms and jacobian",
                          "stamps without %s given to a plan that needs them",
                          stamps->jacobian == NULL ? "Jacobians" : "coefficients of the PSF");
    }
    if (stamps->nx == g->nx && stamps->ny == g->ny)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_INTERNAL, "make a plan for this shape",
                      "stamps of %d x %d px given to a plan for %d x %d px", stamps->nx, stamps->ny,
                      g->nx, g->ny);
}

int shear_measure_range(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                        int from, int to, shear_row *rows, shear_error *err) {
    TRY(check_stamps(plan, stamps, err));
    /* The caller may have put other images into the same memory. */
    ws->power_of = NULL;
    ws->transfer_of = NULL;
    ws->sharpness_of = NULL;
    for (int i = from; i < to; i++) {
        stamp_pair s = measure_pair_at(plan, ws, stamps, i);
        TRY(measure_one(&s, &rows[i - from], err));
    }
    return SHEAR_OK;
}

int shear_measure(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err) {
    return shear_measure_range(plan, ws, stamps, i, i + 1, row, err);
}

int shear_examine(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err) {
    TRY(check_stamps(plan, stamps, err));
    stamp_pair s = measure_pair_at(plan, ws, stamps, i);
    if (!begin_row(&s, row))
        return SHEAR_OK;
    ws->sharpness_of = NULL;
    s.ph = look(&s, s.galaxy, s.noise);
    row->flags |= flags_of_pixels(&s);
    measure_choose_filter(&s, &row->flags);
    row->flags |= flag_if(!pair_transfer_has_psf(&s), SHEAR_FLAG_PSF_UNUSABLE);
    if (row->flags == 0)
        find_artefact(&s, s.galaxy, s.noise, &s.ph, row);
    for (int k = 1; k < s.planes && row->flags == 0; k++) {
        const double *noise = s.noise + (size_t)k * s.pixels;
        const photometry ph = look(&s, noise, noise);
        check_more_noise(&s, noise, noise, &ph, row);
    }
    return SHEAR_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure one stamp pair, from pixels to its row: flags, transform, moments, terms. */
#include "measure/artefact.h"

#include "base/cleanup.h"
#include "measure/internal.h"
#include "measure/photometry.h"
#include "measure/row.h"
#include "measure/saturation.h"
#include "measure/spectra.h"

#include <math.h>

void measure_choose_filter(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                           int i, const filter_map **fine, const filter_map **coarse,
                           uint32_t *flags) {
    const bool one_grid = plan->info.oversample == 1;
    if (!plan->info.filter_per_stamp) {
        *fine = plan->filtered ? &plan->fine : NULL;
        *coarse = !plan->filtered ? NULL : one_grid ? &plan->fine : &plan->coarse;
        return;
    }
    const double r_gal = stamps->r_gal != NULL ? stamps->r_gal[i] : NAN;
    if (!(r_gal > 0.0) || !isfinite(r_gal)) {
        *flags |= SHEAR_FLAG_BAD_R_GAL;
        return;
    }
    const double core = r_gal + 4.0 * plan->info.beta_px; /* Zhang (2010), section 4.2 */
    filter_map_fill(&ws->fine, core, plan->info.width_px);
    if (!one_grid)
        filter_map_fill(&ws->coarse, core, plan->info.width_px);
    *fine = &ws->fine;
    *coarse = one_grid ? &ws->fine : &ws->coarse;
}

/* Return the PSF image of stamp i; NULL if there is none. */
static const double *psf_of(const shear_plan *plan, const shear_stamps *stamps, int i) {
    const transfer_plan *p = &plan->transfer_plan;
    const int index = stamps->psf_index != NULL ? stamps->psf_index[i] : i;
    return stamps->psf == NULL || index < 0 || index >= stamps->n_psf
               ? NULL
               : stamps->psf + (size_t)index * (size_t)p->psf_nx * (size_t)p->psf_ny;
}

const transfer *measure_choose_transfer(const shear_plan *plan, shear_workspace *ws,
                                        const shear_stamps *stamps, int i, uint32_t *flags) {
    if (plan->has_psf)
        return &plan->transfer;
    const transfer_plan *p = &plan->transfer_plan;
    const double *psf = psf_of(plan, stamps, i);
    if (psf == NULL) {
        *flags |= SHEAR_FLAG_PSF_UNUSABLE;
        return NULL;
    }
    if (psf == ws->transfer_of)
        return &ws->transfer;
    ws->transfer_of = NULL;
    if (transfer_make(&ws->transfer, p, &ws->psf_scratch, psf, NULL) != SHEAR_OK) {
        *flags |= SHEAR_FLAG_PSF_UNUSABLE;
        return NULL;
    }
    ws->transfer_of = psf;
    return &ws->transfer;
}

static int negative_pixel(const shear_plan *plan, const shear_stamps *stamps, int i,
                          const pack_failure *where, shear_error *err) {
    return shear_fail(
        err, SHEAR_E_NEGATIVE,
        "give a pedestal above the most negative pixel, or an interpolation that is not "
        "logarithmic",
        "%s stamp %lld (from 0) is negative at pixel (%d, %d), and %s takes logarithms",
        where->in_noise ? "noise" : "galaxy", (long long)stamps->first + i, where->x + 1,
        where->y + 1, shear_interpolation_name(plan->info.interpolation));
}

static uint32_t flags_of_catalog(const shear_stamps *stamps, int i, double weight) {
    const bool masked = stamps->mask != NULL && stamps->mask[i] != 0;
    const bool bad_weight = !shear_weight_is_good(weight);
    return (masked ? (uint32_t)SHEAR_FLAG_MASKED : 0u) |
           (bad_weight ? (uint32_t)SHEAR_FLAG_BAD_WEIGHT : 0u);
}

/* Return the flux that the filter removes. If the fine grid is that of the pixels, it is what the
 * transform lost of its k = 0, except for the two levels that were subtracted (those of the pair
 * packed last, so not with several noise stamps). */
static double removed_flux(const shear_plan *plan, const shear_workspace *ws,
                           const filter_map *filter, const shear_stamps *stamps,
                           const double *galaxy, const double *noise, double lost) {
    if (filter == NULL)
        return 0.0;
    const size_t pixels = (size_t)filter->nx * (size_t)filter->ny;
    return plan->info.oversample == 1 && plan->settings.noise_correction &&
                   noise_planes(stamps) == 1
               ? lost + (ws->noise_level - ws->level) * filter->sum
               : photometry_removed(filter->value, galaxy, noise, pixels);
}

/* A stamp pair while it is measured. */
typedef struct stamp_pair {
    const double *galaxy, *noise;
    const filter_map *fine, *coarse;
    const transfer *transfer; /* NULL if there is none, or the row is flagged already */
    photometry ph;
    bool packed;
    bool noisy; /* one of its noise stamps varies by more than rounding */
    pack_failure failure;
} stamp_pair;

static uint32_t flags_of_pixels(const photometry *ph) {
    return (ph->galaxy_finite ? 0u : (uint32_t)SHEAR_FLAG_GALAXY_NOT_FINITE) |
           (ph->noise_finite ? 0u : (uint32_t)SHEAR_FLAG_NOISE_NOT_FINITE) |
           (ph->galaxy_finite && ph->galaxy_flat ? (uint32_t)SHEAR_FLAG_EMPTY : 0u);
}

static uint32_t bad_values(const shear_plan *plan, const shear_stamps *stamps,
                           const stamp_pair *s) {
    const size_t planes = (size_t)noise_planes(stamps);
    const double value = plan->settings.bad_value;
    const size_t n = (size_t)plan->info.geometry.nx * (size_t)plan->info.geometry.ny;
    if (isnan(value))
        return 0u;
    return (photometry_holds(s->galaxy, n, value) ? (uint32_t)SHEAR_FLAG_GALAXY_NOT_FINITE : 0u) |
           (photometry_holds(s->noise, planes * n, value) ? (uint32_t)SHEAR_FLAG_NOISE_NOT_FINITE
                                                          : 0u);
}

/* Do everything up to the transform along y, including the photometry. Bad pixels are found on the
 * way; then what was packed is not used. */
static void prepare(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                    stamp_pair *s, uint32_t *flags) {
    uint32_t psf_flag = 0;
    measure_choose_filter(plan, ws, stamps, i, &s->fine, &s->coarse, flags);
    if (*flags == 0)
        s->transfer = measure_choose_transfer(plan, ws, stamps, i, &psf_flag);
    if (s->transfer != NULL) {
        s->packed = pack_pair(plan, ws, s->fine, s->galaxy, s->noise, false, s->transfer, &s->ph,
                              &s->failure);
    } else {
        s->ph = photometry_of(s->galaxy, s->noise, stamps->nx, stamps->ny, ws->strip_most);
    }
    *flags |= flags_of_pixels(&s->ph) | bad_values(plan, stamps, s);
    *flags |= *flags == 0 ? psf_flag : 0u;
}

/* Return the PSF's sharpness, or NULL if stamp i has no PSF. For a PSF per stamp it is computed on
 * request only, because it is slow. */
static const sharpness *choose_sharpness(const shear_plan *plan, shear_workspace *ws,
                                         const shear_stamps *stamps, int i) {
    const shear_geometry *g = &plan->info.geometry;
    const double *psf = plan->has_psf ? NULL : psf_of(plan, stamps, i);
    if (psf == NULL)
        return plan->has_psf ? &plan->sharpness : NULL;
    if (psf != ws->sharpness_of) {
        ws->sharpness = sharpness_of(psf, g->psf_nx, g->psf_ny, g->psf_oversample);
        ws->sharpness_of = psf;
    }
    return &ws->sharpness;
}

/* Find an artefact or a flat top in a pair whose pixels are finite. */
static void find_artefact(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                          int i, const stamp_pair *s, shear_row *row) {
    static const sharpness weakest = {.ratio = 1.0, .leak = 0.0};
    const artefact_pair pair = {.galaxy = s->galaxy,
                                .noise = s->noise,
                                .nx = stamps->nx,
                                .ny = stamps->ny,
                                .ph = &s->ph,
                                .strip_most = ws->strip_most};
    artefact found = {.x = -1, .y = -1};
    if (plan->settings.artefacts == SHEAR_ARTEFACTS_KEEP)
        return;
    if (artefact_suspected(&pair, plan->has_psf ? &plan->sharpness : &weakest)) {
        const sharpness *sharp = choose_sharpness(plan, ws, stamps, i);
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
static void check_more_noise(const shear_plan *plan, shear_workspace *ws,
                             const shear_stamps *stamps, int i, const double *one,
                             const double *two, const photometry *ph, shear_row *row) {
    const stamp_pair s = {.galaxy = one, .noise = two, .ph = *ph};
    shear_row seen = {.artefact_x = -1, .artefact_y = -1};
    if (!ph->galaxy_finite || !ph->noise_finite) {
        row->flags |= SHEAR_FLAG_NOISE_NOT_FINITE;
        return;
    }
    find_artefact(plan, ws, stamps, i, &s, &seen);
    if (seen.flags != 0) {
        row->flags |= SHEAR_FLAG_NOISE_ARTEFACT;
        row->artefact_x = seen.artefact_x;
        row->artefact_y = seen.artefact_y;
    }
}

/* Return whether a noise stamp with pixels from `least` to `most` varies by more than rounding. */
static bool holds_noise(const shear_stamps *stamps, const double *noise, double least, double most,
                        double peak) {
    const size_t n = (size_t)stamps->nx * (size_t)stamps->ny;
    return most > least && !photometry_is_rounding(noise, n, least, most, peak);
}

/* Add two further noise stamps to the sum of all. Return false if they cannot be used: they flag
 * the row, or are negative under a log method (`s->packed` is false). */
static bool add_noise(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                      int i, const double *one, const double *two, stamp_pair *s, spectra *all,
                      shear_row *row) {
    photometry ph;
    if (plan->settings.noise_correction) {
        s->packed = pack_pair(plan, ws, s->fine, one, two, true, s->transfer, &ph, &s->failure);
        s->failure.in_noise = true;
    } else {
        ph = photometry_of(one, two, stamps->nx, stamps->ny, ws->strip_most);
    }
    check_more_noise(plan, ws, stamps, i, one, two, &ph, row);
    if (!s->packed || row->flags != 0)
        return false;
    s->noisy = s->noisy ||
               holds_noise(stamps, one, ph.galaxy_least, ph.galaxy_most, s->ph.galaxy_most) ||
               holds_noise(stamps, two, ph.noise_least, ph.noise_most, s->ph.galaxy_most);
    if (plan->settings.noise_correction) {
        const spectra pair = spectra_of(plan, ws, s->transfer);
        spectra_add_noise(all, &pair, one == two ? 0.5 : 1.0);
    }
    return true;
}

/* Add the noise stamps after the first, two per transform, and replace the first one's noise by the
 * mean of all. Return false if one cannot be used, as above. */
static bool more_noise(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                       int i, stamp_pair *s, spectra *sp, shear_row *row) {
    const int planes = noise_planes(stamps);
    const size_t pixels = (size_t)stamps->nx * (size_t)stamps->ny;
    spectra all = *sp;
    for (int k = 1; k < planes; k += 2) {
        const double *one = s->noise + (size_t)k * pixels;
        const double *two = k + 1 < planes ? one + pixels : one; /* the last one twice, halved */
        if (!add_noise(plan, ws, stamps, i, one, two, s, &all, row))
            return false;
    }
    if (planes > 1)
        spectra_set_noise(sp, &all, planes);
    return true;
}

static stamp_pair stamp_pair_at(const shear_stamps *stamps, int i) {
    const size_t at = (size_t)i * (size_t)stamps->nx * (size_t)stamps->ny;
    return (stamp_pair){.galaxy = stamps->galaxy + at,
                        .noise = stamps->noise + (size_t)noise_planes(stamps) * at};
}

static void row_begin(shear_row *row, const shear_stamps *stamps, int i) {
    const double weight = stamps->weight != NULL ? stamps->weight[i] : 1.0;
    row_init(row, stamps->first + i, weight, flags_of_catalog(stamps, i, weight));
}

static int measure_one(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                       int i, shear_row *row, shear_error *err) {
    stamp_pair s = stamp_pair_at(stamps, i);
    row_begin(row, stamps, i);
    prepare(plan, ws, stamps, i, &s, &row->flags);
    if (row->flags == 0)
        find_artefact(plan, ws, stamps, i, &s, row);
    if (row->flags != 0)
        return SHEAR_OK;
    if (!s.packed)
        return negative_pixel(plan, stamps, i, &s.failure, err);
    spectra sp = spectra_of(plan, ws, s.transfer);
    s.noisy = holds_noise(stamps, s.noise, s.ph.noise_least, s.ph.noise_most, s.ph.galaxy_most);
    if (!more_noise(plan, ws, stamps, i, &s, &sp, row))
        return row->flags != 0 ? SHEAR_OK : negative_pixel(plan, stamps, i, &s.failure, err);
    row_fill_photometry(row, stamps, s.galaxy, s.noise, &s.ph);
    row->flux_removed =
        removed_flux(plan, ws, s.coarse, stamps, s.galaxy, s.noise, s.ph.flux - sp.flux);
    spectra_subtract_plateau(&sp, plan, s.transfer);
    if (!s.noisy)
        spectra_forget_noise(&sp);
    row_fill_noise(row, &sp, plan);
    if (plan->settings.estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS)
        row_fill_cross(row, &sp.cross, plan->info.beta_px, plan->info.r_psf_px);
    row_fill_moments(row, &sp.difference, plan->info.beta_px);
    return SHEAR_OK;
}

static int check_shape(const shear_plan *plan, const shear_stamps *stamps, shear_error *err) {
    const shear_geometry *g = &plan->info.geometry;
    if (stamps->nx == g->nx && stamps->ny == g->ny)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_INTERNAL, "make a plan for this shape",
                      "stamps of %d x %d px given to a plan for %d x %d px", stamps->nx, stamps->ny,
                      g->nx, g->ny);
}

int shear_measure_range(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                        int from, int to, shear_row *rows, shear_error *err) {
    int code = check_shape(plan, stamps, err);
    ws->transfer_of = NULL; /* the caller may have put other images into the same memory */
    ws->sharpness_of = NULL;
    for (int i = from; i < to && code == SHEAR_OK; i++)
        code = measure_one(plan, ws, stamps, i, &rows[i - from], err);
    return code;
}

int shear_measure(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err) {
    return shear_measure_range(plan, ws, stamps, i, i + 1, row, err);
}

int shear_examine(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err) {
    TRY(check_shape(plan, stamps, err));
    stamp_pair s = stamp_pair_at(stamps, i);
    row_begin(row, stamps, i);
    ws->sharpness_of = NULL;
    s.ph = photometry_of(s.galaxy, s.noise, stamps->nx, stamps->ny, ws->strip_most);
    row->flags |= flags_of_pixels(&s.ph) | bad_values(plan, stamps, &s);
    measure_choose_filter(plan, ws, stamps, i, &s.fine, &s.coarse, &row->flags);
    row->flags |=
        !plan->has_psf && psf_of(plan, stamps, i) == NULL ? (uint32_t)SHEAR_FLAG_PSF_UNUSABLE : 0u;
    if (row->flags == 0)
        find_artefact(plan, ws, stamps, i, &s, row);
    for (int k = 1; k < noise_planes(stamps) && row->flags == 0; k++) {
        const double *noise = s.noise + (size_t)k * (size_t)stamps->nx * (size_t)stamps->ny;
        const photometry ph = photometry_of(noise, noise, stamps->nx, stamps->ny, ws->strip_most);
        check_more_noise(plan, ws, stamps, i, noise, noise, &ph, row);
    }
    return SHEAR_OK;
}

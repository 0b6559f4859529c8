/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/block_sums.h"
#include "measure/moments.h"
#include "measure/photometry.h"
#include "measure/plan_impl.h"

#include <math.h>

static void row_init(shear_row *row, double weight, uint32_t flags) {
    *row = (shear_row){.n1 = NAN,
                       .n2 = NAN,
                       .d = NAN,
                       .u = NAN,
                       .v = NAN,
                       .m20 = NAN,
                       .m02 = NAN,
                       .m11 = NAN,
                       .m4 = NAN,
                       .flux = NAN,
                       .snr = NAN,
                       .flux_removed = NAN,
                       .border_mean = NAN,
                       .border_var = NAN,
                       .border_var_noise = NAN,
                       .weight = weight,
                       .flags = flags};
}

/* Flux, signal to noise and the border's excess over the noise stamp. */
static void fill_photometry(shear_row *row, const shear_stamps *st, const double *galaxy,
                            const double *noise, const photometry *ph) {
    const double pixels = (double)st->nx * st->ny;
    row->flux = ph->flux;
    row->snr = ph->noise_var > 0.0 ? row->flux / sqrt(2.0 * pixels * ph->noise_var) : NAN;
    const border of_galaxy = border_of(galaxy, st->nx, st->ny);
    const border of_noise = border_of(noise, st->nx, st->ny);
    row->border_mean = of_galaxy.mean - of_noise.mean;
    row->border_var = of_galaxy.var - of_noise.var;
    row->border_var_noise = of_noise.var;
}

void choose_filter(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                   const filter_map **fine, const filter_map **coarse, uint32_t *flags) {
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
    const double core = r_gal + 4.0 * plan->info.beta_px; /* the paper's choice, section 4.2 */
    filter_map_fill(&ws->fine, core, plan->info.width_px);
    if (!one_grid) {
        filter_map_fill(&ws->coarse, core, plan->info.width_px);
    }
    *fine = &ws->fine;
    *coarse = one_grid ? &ws->fine : &ws->coarse;
}

const transfer *choose_transfer(const shear_plan *plan, shear_workspace *ws,
                                const shear_stamps *stamps, int i, uint32_t *flags) {
    if (plan->has_psf) {
        return &plan->transfer;
    }
    const int index = stamps->psf_index != NULL ? stamps->psf_index[i] : i;
    if (stamps->psf == NULL || index < 0 || index >= stamps->n_psf) {
        *flags |= SHEAR_FLAG_PSF_UNUSABLE;
        return NULL;
    }
    const transfer_plan *p = &plan->transfer_plan;
    const double *psf = stamps->psf + (size_t)index * (size_t)p->psf_nx * (size_t)p->psf_ny;
    if (psf == ws->transfer_of) {
        return &ws->transfer;
    }
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

/* What a stamp's own noise stamp adds to the terms of the symmetry (docs/method.md, section 6): `a`
 * parts of the cross spectrum's terms, with beta^2 lowered so that the noise leans neither way. A
 * small part costs little precision; a smaller one would cost more again, for `lower` grows. */
static void fill_cross(shear_row *row, const moments *m, double beta, double r_psf) {
    static const double a = 0.3;
    const double beta2 = beta * beta;
    const double lower = beta2 - r_psf * r_psf * (1.0 + a * a) / (2.0 * a * a);
    row->cross_n1 = -0.5 * a * (m->m20 - m->m02);
    row->cross_n2 = -a * m->m11;
    row->cross_d = a * (m->m20 + m->m02 - 0.5 * lower * m->m4);
    row->cross_u = a * lower / beta2 * m->u;
    row->cross_v = a * lower / beta2 * m->v;
}

/* METHOD steps 5 and 6. */
static void fill_moments(shear_row *row, const moments *m, double beta) {
    row->m20 = m->m20;
    row->m02 = m->m02;
    row->m11 = m->m11;
    row->m4 = m->m4;
    row->u = m->u;
    row->v = m->v;
    row->n1 = -0.5 * (m->m20 - m->m02);
    row->n2 = -m->m11;
    row->d = m->m20 + m->m02 - 0.5 * beta * beta * m->m4;
    double terms[SHEAR_N_TERMS];
    const double cross = row->cross_n1 + row->cross_n2 + row->cross_d + row->cross_u + row->cross_v;
    if (!block_terms(row, terms) || !isfinite(m->m4) || !isfinite(m->u + m->v + cross)) {
        row_init(row, row->weight, SHEAR_FLAG_OVERFLOW);
    }
}

static uint32_t flags_of_catalogue(const shear_stamps *stamps, int i, double weight) {
    const bool masked = stamps->mask != NULL && stamps->mask[i] != 0;
    const bool bad_weight = !shear_weight_is_good(weight);
    return (masked ? (uint32_t)SHEAR_FLAG_MASKED : 0u) |
           (bad_weight ? (uint32_t)SHEAR_FLAG_BAD_WEIGHT : 0u);
}

int last_group(const shear_plan *plan, const transfer *t) {
    return plan->settings.shot_noise == SHEAR_SHOT_PLATEAU ? plan->plateau.last_group
                                                           : t->jy / FFT_LANES;
}

/* METHOD step 4, of the difference of galaxy and noise: the rows of modes that the transfer lets
 * through, and for a plateau the others, too. `cross`, where its estimator is asked for: of the
 * cross spectrum. */
static moments moments_of(const shear_plan *plan, shear_workspace *ws, const transfer *t,
                          moments *cross, double *filtered_flux) {
    const bool crossed = plan->settings.estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS;
    const bool shot = plan->settings.shot_noise == SHEAR_SHOT_PLATEAU;
    moments m = {0};
    double shot_power = 0.0;
    for (int group = 0; group <= last_group(plan, t); group++) {
        const mode_rows rows = transform_rows(plan, ws, group);
        if (group == 0) { /* Z(0) = sum of galaxy + i sum of noise */
            *filtered_flux = rows.up.re[0] - rows.up.im[0];
        }
        if (group * FFT_LANES <= t->jy) {
            moments_add(&m, &rows, &plan->transfer_plan, t);
            if (crossed) {
                moments_add_cross(cross, &rows, &plan->transfer_plan, t);
            }
        }
        shot_power += shot ? plateau_part(&plan->plateau, &rows) : 0.0;
    }
    if (shot) {
        const moments flat = plan->has_psf ? plan->flat : moments_of_flat(&plan->transfer_plan, t);
        moments_subtract(&m, shot_power, &flat);
    }
    return m;
}

/* What the filter takes of the pixels. Where they are the fine grid, that is what the transform
 * lost of its k = 0. */
static double removed_flux(const shear_plan *plan, const filter_map *filter, const double *galaxy,
                           const double *noise, double lost) {
    if (filter == NULL) {
        return 0.0;
    }
    const size_t pixels = (size_t)filter->nx * (size_t)filter->ny;
    return plan->info.oversample == 1 && plan->settings.noise_correction
               ? lost
               : photometry_removed(filter->value, galaxy, noise, pixels);
}

/* A stamp pair on its way. */
typedef struct subject {
    const double *galaxy, *noise;
    const filter_map *fine, *coarse;
    const transfer *transfer; /* NULL where there is none, or the row is flagged already */
    photometry ph;
    bool packed;
    pack_failure failure;
} subject;

static uint32_t flags_of_pixels(const photometry *ph) {
    return (ph->galaxy_finite ? 0u : (uint32_t)SHEAR_FLAG_GALAXY_NOT_FINITE) |
           (ph->noise_finite ? 0u : (uint32_t)SHEAR_FLAG_NOISE_NOT_FINITE) |
           (ph->galaxy_finite && ph->galaxy_flat ? (uint32_t)SHEAR_FLAG_EMPTY : 0u);
}

/* Everything up to the transform along y; the pixels' photometry comes with it. Bad pixels are
 * found on the way, and then what was packed is not used. */
static void take_up(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                    subject *s, uint32_t *flags) {
    uint32_t psf_flag = 0;
    choose_filter(plan, ws, stamps, i, &s->fine, &s->coarse, flags);
    if (*flags == 0) {
        s->transfer = choose_transfer(plan, ws, stamps, i, &psf_flag);
    }
    if (s->transfer != NULL) {
        s->packed = pack_pair(plan, ws, s->fine, s->galaxy, s->noise, last_group(plan, s->transfer),
                              &s->ph, &s->failure);
    } else {
        s->ph = photometry_of(s->galaxy, s->noise, stamps->nx, stamps->ny);
    }
    *flags |= flags_of_pixels(&s->ph);
    *flags |= *flags == 0 ? psf_flag : 0u;
}

static int measure_one(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                       int i, shear_row *row, shear_error *err) {
    const size_t at = (size_t)i * (size_t)stamps->nx * (size_t)stamps->ny;
    const double weight = stamps->weight != NULL ? stamps->weight[i] : 1.0;
    subject s = {.galaxy = stamps->galaxy + at, .noise = stamps->noise + at};
    row_init(row, weight, flags_of_catalogue(stamps, i, weight));
    take_up(plan, ws, stamps, i, &s, &row->flags);
    if (row->flags != 0) {
        return SHEAR_OK;
    }
    if (!s.packed) {
        return negative_pixel(plan, stamps, i, &s.failure, err);
    }
    double filtered_flux = 0.0;
    moments cross = {0};
    const moments m = moments_of(plan, ws, s.transfer, &cross, &filtered_flux);
    fill_photometry(row, stamps, s.galaxy, s.noise, &s.ph);
    row->flux_removed = removed_flux(plan, s.coarse, s.galaxy, s.noise, s.ph.flux - filtered_flux);
    if (plan->settings.estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS) {
        fill_cross(row, &cross, plan->info.beta_px, plan->info.r_psf_px);
    }
    fill_moments(row, &m, plan->info.beta_px);
    return SHEAR_OK;
}

static int check_shape(const shear_plan *plan, const shear_stamps *stamps, shear_error *err) {
    const shear_geometry *g = &plan->info.geometry;
    if (stamps->nx == g->nx && stamps->ny == g->ny) {
        return SHEAR_OK;
    }
    return shear_fail(err, SHEAR_E_INTERNAL, "make a plan for this shape",
                      "stamps of %d x %d px given to a plan for %d x %d px", stamps->nx, stamps->ny,
                      g->nx, g->ny);
}

int shear_measure_range(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                        int from, int to, shear_row *rows, shear_error *err) {
    int code = check_shape(plan, stamps, err);
    ws->transfer_of = NULL; /* the caller may have put other images into the same memory */
    for (int i = from; i < to && code == SHEAR_OK; i++) {
        code = measure_one(plan, ws, stamps, i, &rows[i - from], err);
    }
    return code;
}

int shear_measure(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err) {
    return shear_measure_range(plan, ws, stamps, i, i + 1, row, err);
}

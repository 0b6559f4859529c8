/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/simd.h"
#include "measure/block_sums.h"
#include "measure/moments.h"
#include "measure/plan_impl.h"

#include <math.h>

/* What one pass over a stamp's pixels tells. */
typedef struct pixel_scan {
    double sum, low, high;
    double var; /* about the mean */
    bool finite;
} pixel_scan;

SHEAR_SIMD static pixel_scan scan_pixels(const double *pixels, size_t n) {
    /* Squares are taken about one of the pixels: about zero, a bright sky would swallow its own
     * noise. */
    const double origin = pixels[0];
    double sum = 0.0;
    double sum1 = 0.0;
    double sum2 = 0.0;
    double low = INFINITY;
    double high = -INFINITY;
    double not_finite = 0.0; /* becomes NaN with the first NaN or infinity */
#pragma omp simd reduction(+ : sum, sum1, sum2, not_finite) reduction(min : low) reduction(max : high)
    for (size_t i = 0; i < n; i++) {
        const double p = pixels[i];
        sum += p;
        sum1 += p - origin;
        sum2 += (p - origin) * (p - origin);
        not_finite += p * 0.0;
        low = p < low ? p : low;
        high = p > high ? p : high;
    }
    const double mean = sum1 / (double)n;
    const double var = fmax(0.0, sum2 / (double)n - mean * mean);
    return (pixel_scan){
        .sum = sum, .low = low, .high = high, .var = var, .finite = not_finite == 0.0};
}

/* Mean and variance of the one-pixel border. */
typedef struct border {
    double mean, var;
} border;

static border scan_border(const double *pixels, int nx, int ny) {
    const int n = 2 * (nx + ny) - 4;
    double mean = 0.0;
    for (int pass = 0;; pass++) {
        double sum = 0.0;
        for (int y = 0; y < ny; y++) {
            const int step = y == 0 || y == ny - 1 ? 1 : nx - 1;
            for (int x = 0; x < nx; x += step) {
                const double p = pixels[(size_t)y * (size_t)nx + (size_t)x] - mean;
                sum += pass == 0 ? p : p * p;
            }
        }
        if (pass == 1) {
            return (border){.mean = mean, .var = sum / (n - 1)};
        }
        mean = sum / n;
    }
}

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
                            const double *noise, const pixel_scan *g, const pixel_scan *n) {
    const double pixels = (double)st->nx * st->ny;
    /* A constant noise stamp (all zero, say) has no variance but that of rounding. */
    const bool noisy = n->high > n->low;
    row->flux = g->sum - n->sum;
    row->snr = noisy ? row->flux / sqrt(2.0 * pixels * n->var) : NAN;
    const border of_galaxy = scan_border(galaxy, st->nx, st->ny);
    const border of_noise = scan_border(noise, st->nx, st->ny);
    row->border_mean = of_galaxy.mean - of_noise.mean;
    row->border_var = of_galaxy.var - of_noise.var;
    row->border_var_noise = of_noise.var;
}

SHEAR_SIMD static double removed_flux(const filter_map *coarse, const double *galaxy,
                                      const double *noise) {
    const size_t n = (size_t)coarse->nx * (size_t)coarse->ny;
    const double *value = coarse->value;
    double removed = 0.0;
#pragma omp simd reduction(+ : removed)
    for (size_t i = 0; i < n; i++) {
        removed += (1.0 - value[i]) * (galaxy[i] - noise[i]);
    }
    return removed;
}

void choose_filter(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                   const filter_map **fine, const filter_map **coarse, uint32_t *flags) {
    *fine = plan->filtered ? &plan->fine : NULL;
    *coarse = plan->filtered ? &plan->coarse : NULL;
    if (!plan->info.filter_per_stamp) {
        return;
    }
    const double r_gal = stamps->r_gal != NULL ? stamps->r_gal[i] : NAN;
    if (!(r_gal > 0.0) || !isfinite(r_gal)) {
        *flags |= SHEAR_FLAG_BAD_R_GAL;
        return;
    }
    const double core = r_gal + 4.0 * plan->info.beta_px; /* the paper's choice, section 4.2 */
    filter_map_fill(&ws->fine, core, plan->info.width_px);
    filter_map_fill(&ws->coarse, core, plan->info.width_px);
    *fine = &ws->fine;
    *coarse = &ws->coarse;
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
    if (transfer_make(&ws->transfer, p, &ws->scratch, psf, NULL) != SHEAR_OK) {
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
    if (!block_terms(row, terms) || !isfinite(m->m4) || !isfinite(m->u + m->v)) {
        row_init(row, row->weight, SHEAR_FLAG_OVERFLOW);
    }
}

static uint32_t flags_of_catalogue(const shear_stamps *stamps, int i, double weight) {
    const bool masked = stamps->mask != NULL && stamps->mask[i] != 0;
    const bool bad_weight = !(weight >= 0.0) || !isfinite(weight);
    return (masked ? (uint32_t)SHEAR_FLAG_MASKED : 0u) |
           (bad_weight ? (uint32_t)SHEAR_FLAG_BAD_WEIGHT : 0u);
}

static int measure_one(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                       int i, shear_row *row, shear_error *err) {
    const size_t pixels = (size_t)stamps->nx * (size_t)stamps->ny;
    const double *galaxy = stamps->galaxy + (size_t)i * pixels;
    const double *noise = stamps->noise + (size_t)i * pixels;
    const double weight = stamps->weight != NULL ? stamps->weight[i] : 1.0;
    row_init(row, weight, flags_of_catalogue(stamps, i, weight));
    const pixel_scan g = scan_pixels(galaxy, pixels);
    const pixel_scan n = scan_pixels(noise, pixels);
    row->flags |= g.finite ? 0u : (uint32_t)SHEAR_FLAG_GALAXY_NOT_FINITE;
    row->flags |= n.finite ? 0u : (uint32_t)SHEAR_FLAG_NOISE_NOT_FINITE;
    row->flags |= g.finite && g.low == g.high ? (uint32_t)SHEAR_FLAG_EMPTY : 0u;
    const filter_map *fine = NULL;
    const filter_map *coarse = NULL;
    choose_filter(plan, ws, stamps, i, &fine, &coarse, &row->flags);
    if (row->flags != 0) {
        return SHEAR_OK;
    }
    const transfer *t = choose_transfer(plan, ws, stamps, i, &row->flags);
    if (t == NULL) {
        return SHEAR_OK;
    }
    fill_photometry(row, stamps, galaxy, noise, &g, &n);
    row->flux_removed = coarse != NULL ? removed_flux(coarse, galaxy, noise) : 0.0;
    pack_failure failure;
    if (!pack_pair(plan, ws, fine, galaxy, noise, &failure)) {
        return negative_pixel(plan, stamps, i, &failure, err);
    }
    transform_pair(plan, ws, fine, t);
    const moments m =
        moments_of(ws->pair, plan->stride, &plan->transfer_plan, t, shot_power(plan, ws));
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

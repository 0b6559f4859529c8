/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/transfer.h"

#include "base/cleanup.h"
#include "base/simd.h"
#include "shear/psf.h"

#include <assert.h>
#include <math.h>

/* Return where column jx of a table begins. */
static size_t column_of(const transfer_plan *p, int jx) {
    return (size_t)(jx + p->max_jx) * p->stride;
}

static double kx2_of(const transfer_plan *p, int jx) {
    const double ux = 2.0 * M_PI / p->nx;
    return (ux * jx) * (ux * jx);
}

/* Fill |W_beta|^2 on the modes, with the factor of both halves and that of integrals over the
 * plane. */
static void fill_target(transfer_plan *p) {
    const double uy = 2.0 * M_PI / p->ny;
    const double s2 = (double)p->s * p->s;
    const double norm = 1.0 / ((double)p->nx * p->ny * s2 * s2);
    for (int jy = 0; jy < (int)p->stride; jy++)
        p->ky2[jy] = jy <= p->max_jy ? (uy * jy) * (uy * jy) : INFINITY;
    for (int jx = -p->max_jx; jx <= p->max_jx; jx++) {
        double *column = p->target + column_of(p, jx);
        for (int jy = 0; jy < (int)p->stride; jy++) {
            const double k2 = kx2_of(p, jx) + p->ky2[jy];
            column[jy] = (jy > 0 ? 2.0 : 1.0) * norm * exp(-p->beta_px * p->beta_px * k2);
        }
    }
}

/* Return the fine points of the PSF along an axis, without the closing cells of its interpolation:
 * its image is not periodic, and what lies beyond its last sample, on one side only, would shift
 * and shear it. */
static int psf_fine(const axis *ax) {
    return ax->n * ax->s - (ax->s - 1);
}

void transfer_plan_place(transfer_plan *p, arena *a) {
    const int side = p->s < p->q ? p->s : p->q;
    p->k_limit = M_PI * side;
    /* The largest index of a mode inside the circle: 2 pi j / n < k_limit. */
    p->max_jx = (p->nx * side - 1) / 2;
    p->max_jy = (p->ny * side - 1) / 2;
    p->stride = fft_padded(p->max_jy + 1);
    p->table_size = (2 * (size_t)p->max_jx + 1) * p->stride;
    p->period_nx = p->nx * p->q;
    p->period_ny = p->ny * p->q;
    p->psf_fine_nx = psf_fine(&p->grid.x);
    p->psf_fine_ny = psf_fine(&p->grid.y);
    p->used_nx = p->psf_fine_nx < p->period_nx ? p->psf_fine_nx : p->period_nx;
    p->used_ny = p->psf_fine_ny < p->period_ny ? p->psf_fine_ny : p->period_ny;
    p->ky2 = arena_doubles(a, p->stride);
    p->target = arena_doubles(a, p->table_size);
    if (a->memory != NULL)
        fill_target(p);
}

void transfer_place(transfer *t, const transfer_plan *p, arena *a) {
    *t = (transfer){.jx = p->max_jx,
                    .jy = p->max_jy,
                    .t = arena_doubles(a, p->table_size),
                    .reach = arena_take(a, p->stride / FFT_LANES * sizeof *t->reach)};
}

/* Return the smallest ky^2 of a column at which |W|^2 is below the threshold, or NaN. */
SHEAR_SIMD static double lowest_below(const double *power, const double *ky2, size_t n,
                                      double threshold) {
    double lowest = INFINITY;
#pragma omp simd reduction(min : lowest)
    for (size_t jy = 0; jy < n; jy++) {
        const double k2 = power[jy] >= threshold ? INFINITY : ky2[jy];
        lowest = k2 < lowest ? k2 : lowest;
    }
    return lowest;
}

/* Return the isotropic cut: the smallest |k| at which |W|^2 is below the threshold, at most the
 * Nyquist circle. */
static double find_cut(const transfer_plan *p, const transfer_scratch *t) {
    double cut2 = p->k_limit * p->k_limit;
    for (int jx = -p->max_jx; jx <= p->max_jx; jx++) {
        const double *column = t->power + column_of(p, jx);
        const double k2 = kx2_of(p, jx) + lowest_below(column, p->ky2, p->stride, p->threshold);
        cut2 = k2 < cut2 ? k2 : cut2;
    }
    return sqrt(cut2);
}

/* Return the limit of k^2 inside the cut. The square root rounds, and so does the k^2 of every
 * mode: modes with the cut's own |k| may come out slightly below it. They belong outside like the
 * cut mode itself, by whose |W|^2 nothing may be divided. Modes of another |k| differ by at least
 * 1e-12 of k^2. */
static double inside_cut(double k_cut) {
    return k_cut * k_cut * (1.0 - 0x1p-46);
}

double transfer_power_beyond(double beta_px, double k_cut) {
    const double x = (beta_px * k_cut) * (beta_px * k_cut);
    return (1.0 + x + 0.5 * x * x) * exp(-x);
}

/* Rounded up to the digits that a message prints, so that the printed number works. */
double transfer_smallest_beta(double k_cut, double tolerance) {
    double low = 0.0;
    double high = 1.0;
    while (transfer_power_beyond(high, k_cut) > tolerance) {
        high *= 2.0;
        if (!isfinite(high))
            return INFINITY;
    }
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (transfer_power_beyond(middle, k_cut) > tolerance) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return ceil(1e4 * high) / 1e4;
}

SHEAR_SIMD static void fill_column(const double *target, const double *power, const double *ky2,
                                   double kx2, double cut2, size_t n, double *t) {
#pragma omp simd
    for (size_t jy = 0; jy < n; jy++)
        t[jy] = kx2 + ky2[jy] < cut2 ? target[jy] / power[jy] : 0.0;
}

/* Compute T from |W|^2: columns [-jx, jx], whole groups of rows up to jy. */
static void fill_table(transfer *t, const transfer_plan *p, const transfer_scratch *scratch) {
    for (int jx = -t->jx; jx <= t->jx; jx++) {
        const size_t column = column_of(p, jx);
        fill_column(p->target + column, scratch->power + column, p->ky2, kx2_of(p, jx),
                    inside_cut(t->k_cut), fft_padded(t->jy + 1), t->t + column);
    }
}

/* Return the largest k^4 T of a column. */
SHEAR_SIMD static double largest_weight(const double *t, const double *ky2, double kx2, size_t n) {
    double most = 0.0;
#pragma omp simd reduction(max : most)
    for (size_t jy = 0; jy < n; jy++) {
        const double k2 = kx2 + ky2[jy];
        const double weight = t[jy] > 0.0 ? k2 * k2 * t[jy] : 0.0;
        most = weight > most ? weight : most;
    }
    return most;
}

/* Return the largest k^2 of a column whose k^4 T is more than `least`. */
SHEAR_SIMD static double farthest(const double *t, const double *ky2, double kx2, size_t n,
                                  double least) {
    double most = 0.0;
#pragma omp simd reduction(max : most)
    for (size_t jy = 0; jy < n; jy++) {
        const double k2 = kx2 + ky2[jy];
        const double reached = t[jy] > 0.0 && k2 * k2 * t[jy] > least ? k2 : 0.0;
        most = reached > most ? reached : most;
    }
    return most;
}

/* Return the |k| beyond which T is negligible: a transfer's edge is often not worth its
 * transforms. */
static double find_reach(const transfer *t, const transfer_plan *p) {
    static const double nothing = 1e-15;
    const size_t n = (size_t)t->jy + 1;
    double most = 0.0;
    double k2 = 0.0;
    for (int jx = -t->jx; jx <= t->jx; jx++)
        most = fmax(most, largest_weight(t->t + column_of(p, jx), p->ky2, kx2_of(p, jx), n));
    const double least = nothing * most;
    for (int jx = -t->jx; jx <= t->jx; jx++)
        k2 = fmax(k2, farthest(t->t + column_of(p, jx), p->ky2, kx2_of(p, jx), n, least));
    return sqrt(k2);
}

SHEAR_SIMD static void end_column(const double *ky2, double kx2, double reach2, size_t n,
                                  double *t) {
#pragma omp simd
    for (size_t jy = 0; jy < n; jy++)
        t[jy] = kx2 + ky2[jy] <= reach2 ? t[jy] : 0.0;
}

/* Set T = 0 beyond its reach. Modes of the same |k| as the farthest one are kept like it, however
 * they round. */
static void end_table(transfer *t, const transfer_plan *p) {
    const double reach2 = t->k_reach * t->k_reach * (1.0 + 0x1p-46);
    const size_t n = fft_padded(t->jy + 1);
    for (int jx = -t->jx; jx <= t->jx; jx++)
        end_column(p->ky2, kx2_of(p, jx), reach2, n, t->t + column_of(p, jx));
}

static int last_mode(double k_cut, int n, int max_j) {
    assert(k_cut >= 0.0);
    const int j = (int)floor(k_cut * n / (2.0 * M_PI));
    return j < max_j ? j : max_j;
}

/* Return one mode more than the root gives, because it rounds. */
static int reach_mode(double k, int n, int max_j) {
    return last_mode(k, n, max_j - 1) + 1;
}

static void fill_reach(transfer *t, const transfer_plan *p) {
    for (int jy = 0; jy <= t->jy; jy += FFT_LANES) {
        const double ky = 2.0 * M_PI / p->ny * jy;
        const double left = t->k_reach * t->k_reach - ky * ky;
        t->reach[jy / FFT_LANES] = reach_mode(left > 0.0 ? sqrt(left) : 0.0, p->nx, t->jx);
    }
}

static int load_psf(const transfer_plan *p, transfer_scratch *scratch, const double *psf,
                    shear_error *err) {
    int bad_x;
    int bad_y;
    TRY(shear_psf_usable(psf, p->psf_nx, p->psf_ny, err));
    if (!surface_load(&scratch->image, &p->grid, psf, &bad_x, &bad_y)) {
        return shear_fail(
            err, SHEAR_E_NEGATIVE,
            "give a PSF without negative samples, or sampled finer (OVERSAMP), or an interpolation "
            "that is not logarithmic",
            "the PSF is negative at sample (%d, %d), and a log method interpolates it", bad_x + 1,
            bad_y + 1);
    }
    return SHEAR_OK;
}

static int check_beta(const transfer_plan *p, double k_cut, shear_error *err) {
    if (!(transfer_power_beyond(p->beta_px, k_cut) > p->power_tolerance))
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_BETA, "use a larger beta (or beta-ratio)",
                      "beta = %.4g px is too small: the PSF holds information only up to k = %.4g "
                      "rad/px; the smallest beta that works is %.4f px",
                      p->beta_px, k_cut, transfer_smallest_beta(k_cut, p->power_tolerance));
}

int transfer_make(transfer *t, const transfer_plan *p, transfer_scratch *scratch, const double *psf,
                  shear_error *err) {
    TRY(load_psf(p, scratch, psf, err));
    transfer_find_power(p, scratch);
    t->k_cut = find_cut(p, scratch);
    TRY(check_beta(p, t->k_cut, err));
    t->jx = last_mode(t->k_cut, p->nx, p->max_jx);
    t->jy = last_mode(t->k_cut, p->ny, p->max_jy);
    fill_table(t, p, scratch);
    t->k_reach = find_reach(t, p);
    t->jx = reach_mode(t->k_reach, p->nx, t->jx);
    t->jy = reach_mode(t->k_reach, p->ny, t->jy);
    fill_reach(t, p);
    end_table(t, p);
    return SHEAR_OK;
}

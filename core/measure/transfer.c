/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/transfer.h"

#include "base/cleanup.h"
#include "base/simd.h"

#include <math.h>

void transfer_place(transfer *t, const mode_plane *p, arena *a) {
    *t = (transfer){.jx = p->max_jx,
                    .jy = p->max_jy,
                    .t = arena_doubles(a, p->size),
                    .reach = arena_take(a, p->stride / FFT_LANES * sizeof *t->reach)};
}

/* Return the smallest |k|^2 of a column at which |W|^2 is below the threshold, or NaN. */
SHEAR_SIMD static double lowest_below(const double *power, const double *k2, size_t n,
                                      double threshold) {
    double lowest = INFINITY;
#pragma omp simd reduction(min : lowest)
    for (size_t jy = 0; jy < n; jy++) {
        const double below = power[jy] >= threshold ? INFINITY : k2[jy];
        lowest = below < lowest ? below : lowest;
    }
    return lowest;
}

/* Return the isotropic cut: the smallest |k| at which |W|^2 is below the threshold, at most the
 * Nyquist circle. */
static double find_cut(const transfer_plan *p, const target *goal, const double *power) {
    const size_t n = fft_padded(goal->aim.jy + 1);
    double cut2 = goal->aim.limit * goal->aim.limit;
    for (int jx = -goal->aim.jx; jx <= goal->aim.jx; jx++) {
        const size_t column = mode_plane_column(&p->plane, jx);
        const double k2 = lowest_below(power + column, goal->k2 + column, n, p->threshold);
        cut2 = k2 < cut2 ? k2 : cut2;
    }
    return sqrt(cut2);
}

/* The square root rounds, and so does the |k|^2 of every mode: modes with the cut's own |k| may
 * come out slightly below it. They belong outside like the cut mode itself, by whose |W|^2 nothing
 * may be divided. Modes of another |k| differ by at least 1e-12 of k^2. */
double transfer_inside(double k_cut) {
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

SHEAR_SIMD static void fill_column(const double *goal, const double *power, const double *k2,
                                   double cut2, size_t n, double *t) {
#pragma omp simd
    for (size_t jy = 0; jy < n; jy++)
        t[jy] = k2[jy] < cut2 ? goal[jy] / power[jy] : 0.0;
}

/* Compute T from |W|^2: columns [-jx, jx], whole groups of rows up to jy. */
static void fill_table(transfer *t, const mode_plane *p, const target *goal, const double *power) {
    for (int jx = -t->jx; jx <= t->jx; jx++) {
        const size_t column = mode_plane_column(p, jx);
        fill_column(goal->power + column, power + column, goal->k2 + column,
                    transfer_inside(t->k_cut), fft_padded(t->jy + 1), t->t + column);
    }
}

/* Return the largest k^4 T of a column. */
SHEAR_SIMD static double largest_weight(const double *t, const double *k2, size_t n) {
    double most = 0.0;
#pragma omp simd reduction(max : most)
    for (size_t jy = 0; jy < n; jy++) {
        const double weight = t[jy] > 0.0 ? k2[jy] * k2[jy] * t[jy] : 0.0;
        most = weight > most ? weight : most;
    }
    return most;
}

/* Return the largest |k|^2 of a column whose k^4 T is more than `least`. */
SHEAR_SIMD static double farthest(const double *t, const double *k2, size_t n, double least) {
    double most = 0.0;
#pragma omp simd reduction(max : most)
    for (size_t jy = 0; jy < n; jy++) {
        const double reached = t[jy] > 0.0 && k2[jy] * k2[jy] * t[jy] > least ? k2[jy] : 0.0;
        most = reached > most ? reached : most;
    }
    return most;
}

/* Return the |k| beyond which T is negligible: a transfer's edge is often not worth its
 * transforms. */
static double find_reach(const transfer *t, const mode_plane *p, const target *goal) {
    static const double nothing = 1e-15;
    const size_t n = (size_t)t->jy + 1;
    double most = 0.0;
    double reach2 = 0.0;
    for (int jx = -t->jx; jx <= t->jx; jx++) {
        const size_t column = mode_plane_column(p, jx);
        most = fmax(most, largest_weight(t->t + column, goal->k2 + column, n));
    }
    const double least = nothing * most;
    for (int jx = -t->jx; jx <= t->jx; jx++) {
        const size_t column = mode_plane_column(p, jx);
        reach2 = fmax(reach2, farthest(t->t + column, goal->k2 + column, n, least));
    }
    return sqrt(reach2);
}

SHEAR_SIMD static void end_column(const double *k2, double reach2, size_t n, double *t) {
#pragma omp simd
    for (size_t jy = 0; jy < n; jy++)
        t[jy] = k2[jy] <= reach2 ? t[jy] : 0.0;
}

/* Set T = 0 beyond its reach. Modes of the same |k| as the farthest one are kept like it, however
 * they round. */
static void end_table(transfer *t, const mode_plane *p, const target *goal) {
    const double reach2 = t->k_reach * t->k_reach * (1.0 + 0x1p-46);
    const size_t n = fft_padded(t->jy + 1);
    for (int jx = -t->jx; jx <= t->jx; jx++) {
        const size_t column = mode_plane_column(p, jx);
        end_column(goal->k2 + column, reach2, n, t->t + column);
    }
}

/* Set the last modes that count, one more than the roots give, because they round. */
static void set_reach(transfer *t, const mode_plane *p, const target *goal) {
    const int jx = t->jx;
    t->jx = target_last_jx(&goal->aim, p, t->k_reach, 0, jx - 1) + 1;
    t->jy = target_last_jy(&goal->aim, p, t->k_reach, t->jy - 1) + 1;
    for (int jy = 0; jy <= t->jy; jy += FFT_LANES)
        t->reach[jy / FFT_LANES] = target_last_jx(&goal->aim, p, t->k_reach, jy, t->jx - 1) + 1;
}

bool transfer_sees(const transfer_plan *p, double beta, double k_cut) {
    return !(transfer_power_beyond(beta, k_cut) > p->power_tolerance);
}

static int check_beta(const transfer_plan *p, double beta, double k_cut, shear_error *err) {
    if (transfer_sees(p, beta, k_cut))
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_BETA, "use a larger beta (or beta-ratio)",
                      "beta = %.4g px is too small: the PSF holds information only up to k = %.4g "
                      "rad/px; the smallest beta that works is %.4f px",
                      beta, k_cut, transfer_smallest_beta(k_cut, p->power_tolerance));
}

int transfer_make(transfer *t, const transfer_plan *p, const double *power, shear_error *err) {
    const mode_plane *m = &p->plane;
    const target *goal = &p->target;
    t->k_cut = find_cut(p, goal, power);
    TRY(check_beta(p, goal->aim.beta, t->k_cut, err));
    t->jx = target_last_jx(&goal->aim, m, t->k_cut, 0, goal->aim.jx);
    t->jy = target_last_jy(&goal->aim, m, t->k_cut, goal->aim.jy);
    fill_table(t, m, goal, power);
    t->k_reach = find_reach(t, m, goal);
    set_reach(t, m, goal);
    end_table(t, m, goal);
    return SHEAR_OK;
}

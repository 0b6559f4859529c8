/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/field_sums.h"

#include "shear/settings.h"

#include <math.h>

/* The delta method for a ratio of sums, g = sum w N / sum w D (METHOD section 2), with the squares
 * multiplied out: sum w^2 (Na - ga D)(Nb - gb D) = NaNb - ga NbD - gb NaD + ga gb DD. */
static double covariance(double na_nb, double na_d, double nb_d, double dd, double ga, double gb,
                         double d) {
    return (na_nb - ga * nb_d - gb * na_d + ga * gb * dd) / (d * d);
}

/* Squares of very faint units (pixels of 1e-75) lose their digits below this: then the errors are
 * not known. */
static const double smallest_square = 1e-290;

/* Mean of a term over the used stamps, and the error of that mean. */
static void mean_of(const double *t, int sum, int squares, double n, double *mean,
                    double *mean_err) {
    *mean = t[sum] / n;
    const double variance = fmax(0.0, t[squares] / n - *mean * *mean);
    *mean_err = sqrt(variance / (n - 1.0));
}

static void fill_shear(shear_result *r, const double *t) {
    const double d = t[SHEAR_S_D];
    r->g1 = t[SHEAR_S_N1] / d;
    r->g2 = t[SHEAR_S_N2] / d;
    const double v1 =
        covariance(t[SHEAR_S_N1N1], t[SHEAR_S_N1D], t[SHEAR_S_N1D], t[SHEAR_S_DD], r->g1, r->g1, d);
    const double v2 =
        covariance(t[SHEAR_S_N2N2], t[SHEAR_S_N2D], t[SHEAR_S_N2D], t[SHEAR_S_DD], r->g2, r->g2, d);
    r->cov12 =
        covariance(t[SHEAR_S_N1N2], t[SHEAR_S_N1D], t[SHEAR_S_N2D], t[SHEAR_S_DD], r->g1, r->g2, d);
    r->g1_err = sqrt(fmax(0.0, v1));
    r->g2_err = sqrt(fmax(0.0, v2));
    if (!(t[SHEAR_S_DD] > smallest_square)) {
        r->g1_err = r->g2_err = r->cov12 = NAN;
    }
}

static void fill_diagnostics(shear_result *r, const double *t) {
    const double n = (double)r->n_used;
    double removed;
    double removed_err;
    r->mean_flux = t[SHEAR_S_FLUX] / n;
    mean_of(t, SHEAR_S_REMOVED, SHEAR_S_REMOVED2, n, &removed, &removed_err);
    r->filter_removed = removed / r->mean_flux;
    r->filter_removed_err = removed_err / fabs(r->mean_flux);
    mean_of(t, SHEAR_S_BORDER_MEAN, SHEAR_S_BORDER_MEAN2, n, &r->border_excess,
            &r->border_excess_err);
    mean_of(t, SHEAR_S_BORDER_VAR, SHEAR_S_BORDER_VAR2, n, &r->border_rough, &r->border_rough_err);
    r->border_noise_var = t[SHEAR_S_BORDER_NOISE] / n;
}

const char *shear_error_method(const shear_result *r) {
    if (r->jackknife > 0) {
        return "jackknife";
    }
    return shear_estimator_is_symmetric(r->estimator) ? "symmetry" : "delta";
}

void shear_field_result(const shear_field_sums *f, shear_result *out) {
    double t[SHEAR_N_TERMS];
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        t[i] = exact_value(f->sums, i);
    }
    *out = (shear_result){.n_stamps = f->n_stamps,
                          .n_used = f->n_used,
                          .n_flagged = f->n_stamps - f->n_used,
                          .sum_weight = t[SHEAR_S_W],
                          .sum_d = t[SHEAR_S_D]};
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        out->flagged[i] = f->flagged[i];
    }
    out->g1 = out->g2 = out->g1_err = out->g2_err = out->cov12 = NAN;
    out->mean_flux = out->filter_removed = out->filter_removed_err = NAN;
    out->border_excess = out->border_excess_err = NAN;
    out->border_rough = out->border_rough_err = out->border_noise_var = NAN;
    if (f->n_used >= 2) {
        fill_diagnostics(out, t);
    }
    if (f->n_used >= 2 && t[SHEAR_S_D] > 0.0) {
        fill_shear(out, t);
        out->valid = isfinite(out->g1) && isfinite(out->g2);
    }
}

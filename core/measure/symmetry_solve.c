/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shear of a field by PDF symmetrization: both components in turn, and their covariance. */
#include "base/cleanup.h"
#include "measure/symmetry_solver.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { PER_BIN = SHEAR_SYMMETRY_FEWEST, MAX_ITERATIONS = 20 /* of both components */ };

/* Set groups and integer weights. Return false if no weight is positive. */
static bool set_weights(symmetry_solver *v) {
    double largest = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < v->s->n; i++) {
        const symmetry_terms *t = &v->s->stamps[i];
        v->group[i] = sign_histogram_group(t->n1, t->n2);
        largest = fmax(largest, t->weight);
    }
    for (size_t i = 0; i < v->s->n && largest > 0.0; i++) {
        const double part = v->s->stamps[i].weight / largest;
        v->weight[i] = (int32_t)lround(part * SHEAR_SYMMETRY_WEIGHTS);
        sum += v->weight[i]; /* sums of integers: exact */
        squares += (double)v->weight[i] * v->weight[i];
    }
    const int terms = squares > 0.0 ? scores_terms(sum * sum / squares) : 0;
    v->components[0].scores.terms = v->components[1].scores.terms = terms;
    return largest > 0.0;
}

/* Set first guesses, bins and scores of both components. */
static bool begin(symmetry_solver *v) {
    for (int iteration = 0; iteration < 2; iteration++) {
        for (int c = 0; c < 2; c++) {
            if (!symmetry_solver_guess(v, c, iteration == 1))
                return false;
        }
    }
    return true;
}

static bool alternate(symmetry_solver *v) {
    for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        double moved = 0.0;
        for (int c = 0; c < 2; c++) {
            const double before = v->components[c].g;
            if (!symmetry_solver_find(v, c))
                return false;
            moved = fmax(moved, fabs(v->components[c].g - before) / v->components[c].sigma);
        }
        if (moved < SOLVER_STILL)
            break;
    }
    return symmetry_solver_set_slope(v, 0) && symmetry_solver_set_slope(v, 1);
}

/* Compute the covariance of the two components: a stamp moves each by its score over the slope. */
static int covariance(symmetry_solver *v, double *cov12, shear_error *err) {
    const solver_component *one = &v->components[0];
    const solver_component *two = &v->components[1];
    assert(one->slope > 0.0 && two->slope > 0.0);
    const size_t nb = (size_t)v->bins;
    /* w^2 with the product of the signs, by both bins */
    CLEANUP(release_free) int64_t *joint = calloc(nb * nb, sizeof *joint);
    if (joint == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %zu bins", nb * nb);
    const sign_histogram h1 = {.bins = v->bins, .edge = one->edge};
    const sign_histogram h2 = {.bins = v->bins, .edge = two->edge};
    for (size_t i = 0; i < v->s->n; i++) {
        const symmetry_terms t = symmetry_solver_terms(v, i);
        const double value1 = t.n1 - one->g * (t.d + t.u) - two->g * t.v;
        const double value2 = t.n2 - two->g * (t.d - t.u) - one->g * t.v;
        const size_t bin1 = (size_t)sign_histogram_bin(&h1, fabs(value1));
        const size_t bin2 = (size_t)sign_histogram_bin(&h2, fabs(value2));
        const int64_t w = v->weight[i];
        joint[bin1 * nb + bin2] += (value1 > 0.0) == (value2 > 0.0) ? w * w : -w * w;
    }
    double sum = 0.0;
    for (size_t i = 0; i < nb; i++) {
        for (size_t k = 0; k < nb; k++)
            sum += one->scores.all[i] * two->scores.all[k] * (double)joint[i * nb + k];
    }
    *cov12 = sum / (one->slope * two->slope);
    return SHEAR_OK;
}

static int solve(symmetry_solver *v, shear_result *out, shear_error *err) {
    if (!set_weights(v) || !begin(v) || !alternate(v))
        return SHEAR_OK;
    TRY(covariance(v, &out->cov12, err));
    out->valid = true;
    out->g1 = v->components[0].g;
    out->g2 = v->components[1].g;
    out->g1_err = v->components[0].sigma;
    out->g2_err = v->components[1].sigma;
    return SHEAR_OK;
}

/* Return whether the mean shows that there are no galaxies to symmetrize. A signal a little too
 * small for the mean may be enough here; but noise alone has a symmetry, too. */
static bool hopeless(const shear_result *mean) {
    static const double least_signal = 3.0;
    return mean->why != SHEAR_HAS_SHEAR &&
           !(mean->why == SHEAR_NO_SIGNAL && mean->signal >= least_signal);
}

/* Solve for terms from which their excess times `shape` is subtracted. */
static int solve_corrected(const shear_symmetry *s, int bins, const noise_shape *shape,
                           shear_result *out, shear_error *err) {
    if (bins < 0 || bins > SHEAR_SYMMETRY_MAX_BINS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "%d bins: 1 to %d are possible", bins,
                          SHEAR_SYMMETRY_MAX_BINS);
    }
    out->estimator = SHEAR_ESTIMATOR_PDF_SYM;
    out->valid = false;
    out->jackknife = 0;
    out->g1 = out->g2 = out->g1_err = out->g2_err = out->cov12 = NAN;
    if (hopeless(out))
        return SHEAR_OK;
    out->why = SHEAR_NO_SYMMETRY;
    const size_t wanted = bins > 0 ? (size_t)bins : SHEAR_SYMMETRY_BINS;
    const size_t most = s->n / PER_BIN;
    if (most == 0)
        return SHEAR_OK;
    CLEANUP(symmetry_solver_deinit) symmetry_solver v;
    TRY(symmetry_solver_init(&v, s, (int)(wanted < most ? wanted : most), shape, err));
    int code = solve(&v, out, err);
    out->why = out->valid ? SHEAR_HAS_SHEAR : SHEAR_NO_SYMMETRY;
    return code;
}

int shear_symmetry_solve(const shear_symmetry *s, int bins, shear_result *out, shear_error *err) {
    const noise_shape none = {0};
    return solve_corrected(s, bins, &none, out, err);
}

int shear_estimate(enum shear_estimator estimator, const shear_field_sums *sums,
                   const shear_symmetry *terms, shear_result *out, shear_error *err) {
    shear_result symmetric;
    shear_field_result(sums, out);
    if (!shear_estimator_is_symmetric(estimator))
        return SHEAR_OK;
    symmetric = *out;
    const noise_shape shape = noise_shape_of(sums);
    TRY(solve_corrected(terms, 0, &shape, &symmetric, err));
    *out = symmetric;
    out->estimator = estimator;
    return SHEAR_OK;
}

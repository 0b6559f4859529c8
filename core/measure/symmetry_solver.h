/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/symmetry_solver.h: one component of the shear by PDF symmetrization, the other one held
 * where it is.
 *
 * X(g) is a step function, for stamps change bins one by one, and its least value is a matter of
 * luck among the steps. So the bins' responses D_i = -d(n_i - n_-i)/dg are taken over a range of g
 * as wide as the galaxies' own scatter, where steps do not matter. With them X is the parabola
 *
 *     X(g) = 1/2 sum_i (n_i - n_-i - (g' - g) D_i)^2 / (n_i + n_-i)  about any g,
 *
 * and its minimum is where the score S(g) = sum_i score_i (n_i - n_-i), score_i = D_i / (n_i +
 * n_-i), is 0. S is found from counts at g itself, so the root does not depend on how good D is,
 * and noise in D, being even under exchange of the sides, does not bias it. But noise in D costs
 * precision, and makes S seem steeper than it is: see measure/score.h for what is done. */
#ifndef SHEAR_MEASURE_SYMMETRY_SOLVER_H
#define SHEAR_MEASURE_SYMMETRY_SOLVER_H

#include "measure/score.h"
#include "measure/sign_histogram.h"
#include "measure/symmetry.h"

#include <stdbool.h>

/* A shear that moves less stands still: in units of its sigma. */
#define SOLVER_STILL 1e-3

/* One component of the shear: its error, and what the covariance needs. */
typedef struct solver_component {
    double g, sigma;
    double *edge; /* [bins] */
    scores scores;
    double width; /* of the responses' range, to each side */
    double slope; /* -dS/dg */
} solver_component;

typedef struct symmetry_solver {
    const shear_symmetry *s;
    noise_shape shape; /* of what the excess of its noise adds to a stamp's terms */
    int bins;
    double *x, *b;   /* [n] of the component under way */
    double *scratch; /* [n] */
    int32_t *weight; /* [n] */
    uint8_t *group;  /* [n] */
    sign_counts at;  /* [bins] */
    solver_component components[2];
} symmetry_solver;

/* Deinit it, also after an error. SHEAR_E_NOMEM. */
int symmetry_solver_init(symmetry_solver *v, const shear_symmetry *s, int bins,
                         const noise_shape *shape, shear_error *err);
void symmetry_solver_deinit(symmetry_solver *v);

/* The terms of stamp i without the excess of its noise over its noise stamp's. */
symmetry_terms symmetry_solver_terms(const symmetry_solver *v, size_t i);

/* Each for component c, 0 or 1; false if there is no such shear within |g| < 1. */
/* The weighted median of x/b, a first guess that no bright galaxy can spoil; with `scored`, bins
 * about it and their scores, too. */
bool symmetry_solver_guess(symmetry_solver *v, int c, bool scored);
/* The root of S; sigma as well if it is not known yet. */
bool symmetry_solver_find(symmetry_solver *v, int c);
/* The slope of S about its root, and sigma. */
bool symmetry_solver_set_slope(symmetry_solver *v, int c);

#endif

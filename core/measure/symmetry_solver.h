/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/symmetry_solver.h: solve for one component of the shear by PDF symmetrization, with the
 * other one fixed.
 *
 * X(g) is a step function, because stamps change bins one by one, and the place of its minimum is
 * random among the steps. Therefore the bins' responses D_i = -d(n_i - n_-i)/dg are taken over a
 * range of g as wide as the galaxies' own scatter, where steps do not matter. With them X is the
 * parabola
 *
 *     X(g) = 1/2 sum_i (n_i - n_-i - (g' - g) D_i)^2 / (n_i + n_-i)  about any g,
 *
 * and its minimum is where the score S(g) = sum_i score_i (n_i - n_-i), score_i = D_i / (n_i +
 * n_-i), is 0. S is computed from counts at g itself, so the root does not depend on the accuracy
 * of D, and noise in D, which is even under exchange of the sides, does not bias it. But noise in D
 * costs precision and makes S seem steeper than it is; measure/score.h describes the remedy. */
#pragma once

#include "measure/score.h"
#include "measure/sign_histogram.h"
#include "measure/symmetry.h"

#include <stdbool.h>

/* A step of the shear, in units of its sigma, below which the iteration has converged. */
#define SOLVER_STILL 1e-3

/* One component of the shear, its error, and what the covariance needs. */
typedef struct solver_component {
    double g, sigma;
    double *edge; /* [bins] */
    scores scores;
    double width; /* of the range of the responses, to each side */
    double slope; /* -dS/dg */
} solver_component;

typedef struct symmetry_solver {
    const shear_symmetry *s;
    noise_shape shape; /* by which a stamp's terms change per unit of excess */
    int bins;
    double *x, *b;   /* [n] of the component being solved */
    double *scratch; /* [n] */
    int32_t *weight; /* [n] */
    uint8_t *group;  /* [n] */
    sign_counts at;  /* scratch */
    void *memory;    /* of all arrays */
    solver_component components[2];
} symmetry_solver;

/* Allocate. SHEAR_E_NOMEM; call symmetry_solver_deinit after an error, too. */
int symmetry_solver_init(symmetry_solver *v, const shear_symmetry *s, int bins,
                         const noise_shape *shape, shear_error *err);
void symmetry_solver_deinit(symmetry_solver *v);

/* Return the terms of stamp i, corrected for the excess of its noise over its noise stamp's. */
symmetry_terms symmetry_solver_terms(const symmetry_solver *v, size_t i);

/* All of the following work on component c, 0 or 1, and return false if there is no such shear
 * within |g| < 1. */
/* Set g to the weighted median of x/b, a first guess that no bright galaxy can spoil; with
 * `scored`, make bins about it and their scores, too. */
bool symmetry_solver_guess(symmetry_solver *v, int c, bool scored);
/* Set g to the root of S, and sigma if it is not known yet. */
bool symmetry_solver_find(symmetry_solver *v, int c);
/* Set the slope of S about its root, and sigma. */
bool symmetry_solver_set_slope(symmetry_solver *v, int c);

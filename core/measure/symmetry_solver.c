/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/symmetry_solver.h"

#include "measure/monotone.h"

#include <math.h>
#include <stdlib.h>

static const double widest = 1.0; /* largest |g| */
/* Fraction of the weight that changes sides within the range of the responses. */
static const double scatter = 0.3;
static const double guess_tolerance = 1e-6;

static void place(symmetry_solver *v, arena *a) {
    const size_t n = v->s->n;
    v->x = arena_doubles(a, n);
    v->b = arena_doubles(a, n);
    v->scratch = arena_doubles(a, n);
    v->weight = arena_take(a, n * sizeof *v->weight);
    v->group = arena_take(a, n * sizeof *v->group);
    sign_counts_place(&v->at, v->bins, a);
    for (int c = 0; c < 2; c++) {
        v->components[c].edge = arena_doubles(a, (size_t)v->bins);
        scores_place(&v->components[c].scores, v->bins, a);
    }
}

int symmetry_solver_init(symmetry_solver *v, const shear_symmetry *s, int bins,
                         const noise_shape *shape, shear_error *err) {
    *v = (symmetry_solver){.s = s, .shape = *shape, .bins = bins};
    arena a = {0};
    place(v, &a);
    v->memory = arena_allocate(&a);
    if (v->memory == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory to symmetrize %zu stamps", s->n);
    }
    place(v, &a);
    return SHEAR_OK;
}

void symmetry_solver_deinit(symmetry_solver *v) {
    free(v->memory);
    *v = (symmetry_solver){0};
}

symmetry_terms symmetry_solver_terms(const symmetry_solver *v, size_t i) {
    symmetry_terms t = v->s->stamps[i];
    t.n1 -= t.excess * v->shape.n1;
    t.n2 -= t.excess * v->shape.n2;
    t.d -= t.excess * v->shape.d;
    t.u -= t.excess * v->shape.u;
    t.v -= t.excess * v->shape.v;
    return t;
}

/* Load the values and responses of component c, with the other component fixed. */
static sign_histogram load(symmetry_solver *v, int c) {
    const double other = v->components[1 - c].g;
    for (size_t i = 0; i < v->s->n; i++) {
        const symmetry_terms t = symmetry_solver_terms(v, i);
        v->x[i] = (c == 0 ? t.n1 : t.n2) - other * t.v;
        v->b[i] = c == 0 ? t.d + t.u : t.d - t.u;
    }
    return (sign_histogram){.n = v->s->n,
                            .x = v->x,
                            .b = v->b,
                            .weight = v->weight,
                            .group = v->group,
                            .bins = v->bins,
                            .edge = v->components[c].edge};
}

/* ---- the balance ---- */

typedef struct balance {
    const sign_histogram *histogram;
    double level;
} balance;

static double balance_at(void *context, double g) {
    const balance *b = context;
    return (double)sign_histogram_balance(b->histogram, g) - b->level;
}

/* Find where the balance falls through `level`; for 0, the weighted median of x/b. */
static bool find_balance(const sign_histogram *h, double level, double *g) {
    balance b = {.histogram = h, .level = level};
    if (balance_at(&b, -widest) <= 0.0 || balance_at(&b, widest) > 0.0)
        return false;
    *g = monotone_find_root(balance_at, &b, -widest, widest, guess_tolerance);
    return true;
}

/* Find where `scatter` of the weight has changed sides, below (sign -1) or above g. If noise in the
 * responses keeps the balance smaller than that up to |g| = 1, use half of what it reaches. */
static bool find_scatter(const sign_histogram *h, double sign, double *g) {
    int64_t all = 0;
    for (size_t i = 0; i < h->n; i++)
        all += h->weight[i];
    const double most = fmax(0.0, -sign * (double)sign_histogram_balance(h, sign * widest));
    const double level = fmin(scatter * (double)all, 0.5 * most);
    return find_balance(h, -sign * level, g);
}

/* Set bins about a->g, and the scores. */
static bool set_scores(symmetry_solver *v, solver_component *a, const sign_histogram *h) {
    double low;
    double high;
    if (!find_scatter(h, -1.0, &low) || !find_scatter(h, 1.0, &high) || !(high > low))
        return false;
    sign_histogram_quantiles(h, a->g, v->scratch, a->edge);
    a->width = 0.5 * (high - low);
    scores_fit(&a->scores, h, a->g, a->width);
    return true;
}

bool symmetry_solver_guess(symmetry_solver *v, int c, bool scored) {
    solver_component *a = &v->components[c];
    const sign_histogram h = load(v, c);
    return find_balance(&h, 0, &a->g) && (!scored || set_scores(v, a, &h));
}

/* ---- the score ---- */

/* Return S, and its variance from the stamps' random signs. */
static double score_at(symmetry_solver *v, const solver_component *a, const sign_histogram *h,
                       double g, double *variance) {
    const double *score = a->scores.all;
    double sum = 0.0;
    *variance = 0.0;
    sign_histogram_count(h, g, &v->at);
    for (int i = 0; i < v->bins; i++) {
        int64_t difference = 0;
        int64_t square = 0;
        for (int at = i; at < SIGN_GROUPS * v->bins; at += v->bins) {
            difference += v->at.difference[at];
            square += v->at.square[at];
        }
        sum += score[i] * (double)difference;
        *variance += score[i] * score[i] * (double)square;
    }
    return sum;
}

typedef struct total_score {
    symmetry_solver *solver;
    const solver_component *component;
    const sign_histogram *histogram;
} total_score;

static double total_score_at(void *context, double g) {
    const total_score *s = context;
    double variance;
    return score_at(s->solver, s->component, s->histogram, g, &variance);
}

/* Search from g outwards, in growing steps to the side `sign`, for a place where S has the sign of
 * -`sign`. Return false if there is none. */
static bool find_side(total_score *s, double sign, double step, double *g) {
    *g = s->component->g + sign * step;
    while (fabs(*g) < 2.0 * widest) {
        if (sign * total_score_at(s, *g) < 0.0)
            return true;
        step *= 2.0;
        *g += sign * step;
    }
    return false;
}

/* Find the root of S, near g first. */
static bool find_root(symmetry_solver *v, solver_component *a, const sign_histogram *h,
                      double step) {
    total_score s = {.solver = v, .component = a, .histogram = h};
    double low;
    double high;
    if (!find_side(&s, -1.0, step, &low) || !find_side(&s, 1.0, step, &high))
        return false;
    a->g = monotone_find_root(total_score_at, &s, low, high, 0.1 * SOLVER_STILL * a->sigma);
    return true;
}

/* Guess sigma before the slope is known: with ideal scores the variance of S equals its slope. */
static bool guess_sigma(symmetry_solver *v, solver_component *a, const sign_histogram *h) {
    double information;
    score_at(v, a, h, a->g, &information);
    a->sigma = 1.0 / sqrt(information);
    return information > 0.0;
}

bool symmetry_solver_find(symmetry_solver *v, int c) {
    solver_component *a = &v->components[c];
    const sign_histogram h = load(v, c);
    const bool first = !(a->sigma > 0.0);
    if (first && !guess_sigma(v, a, &h))
        return false;
    return find_root(v, a, &h, first ? a->sigma : 0.1 * a->sigma);
}

/* The slope is taken over a range where neither the steps nor the curvature of S matter. */
bool symmetry_solver_set_slope(symmetry_solver *v, int c) {
    solver_component *a = &v->components[c];
    const sign_histogram h = load(v, c);
    const double half = fmin(0.5 * a->width, fmax(0.2 * a->width, 5.0 * a->sigma));
    double variance;
    score_at(v, a, &h, a->g, &variance);
    a->slope = scores_slope(&a->scores, &h, a->g, half);
    a->sigma = sqrt(variance) / a->slope;
    return a->slope > 0.0 && variance > 0.0;
}

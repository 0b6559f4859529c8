/* SPDX-License-Identifier: GPL-3.0-or-later */
/* X(g) is a step function, for stamps change bins one by one, and its least value is a matter of
 * luck among the steps. So the bins' responses D_i = -d(n_i - n_-i)/dg are taken over a range of g
 * as wide as the galaxies' own scatter, where steps do not matter. With them X is the parabola
 *
 *     X(g) = 1/2 sum_i (n_i - n_-i - (g' - g) D_i)^2 / (n_i + n_-i)  about any g,
 *
 * and its minimum is where the score S(g) = sum_i score_i (n_i - n_-i), score_i = D_i / (n_i +
 * n_-i), is 0. S is found from counts at g itself, so the root does not depend on how good D is,
 * and noise in D, being even under exchange of the sides, does not bias it. But noise in D costs
 * precision, and makes S seem steeper than it is: see measure/score.h for what is done. */
#include "measure/score.h"
#include "measure/sign_histogram.h"
#include "measure/symmetry.h"

#include <math.h>
#include <stdlib.h>

enum {
    PER_BIN = SHEAR_SYMMETRY_FEWEST,
    MAX_STEPS = 60, /* to a root */
    MAX_ROUNDS = 20 /* of alternation */
};
static const double still = 1e-3;  /* sigma: a shear that moves less stands still */
static const double widest = 1.0;  /* |g| */
static const double scatter = 0.3; /* of the weight changes sides within the responses' range */

static const double guess_tolerance = 1e-6;

/* One component: shear, error, and what the covariance needs. */
typedef struct axis {
    double g, sigma;
    double *edge; /* [bins] */
    scores scores;
    double width; /* of the responses' range, to each side */
    double slope; /* -dS/dg */
} axis;

typedef struct solver {
    const shear_symmetry *s;
    noise_shape shape; /* of what the excess of its noise adds to a stamp's terms */
    int bins;
    double *x, *b;   /* [n] of the component under way */
    double *scratch; /* [n] */
    int32_t *weight; /* [n] */
    uint8_t *group;  /* [n] */
    fold_counts at;  /* [bins] */
    axis axes[2];
} solver;

static void solver_deinit(solver *v) {
    free(v->x);
    free(v->b);
    free(v->scratch);
    free(v->weight);
    free(v->group);
    free(v->at.difference);
    free(v->at.square);
    for (int c = 0; c < 2; c++) {
        free(v->axes[c].edge);
        scores_deinit(&v->axes[c].scores);
    }
}

static int solver_init(solver *v, const shear_symmetry *s, int bins, shear_error *err) {
    const size_t n = s->n;
    const size_t nb = (size_t)bins;
    *v = (solver){.s = s, .bins = bins};
    v->x = malloc(n * sizeof *v->x);
    v->b = malloc(n * sizeof *v->b);
    v->scratch = malloc(n * sizeof *v->scratch);
    v->weight = malloc(n * sizeof *v->weight);
    v->group = malloc(n * sizeof *v->group);
    v->at.difference = malloc(nb * sizeof *v->at.difference);
    v->at.square = malloc(nb * sizeof *v->at.square);
    bool made = v->x != NULL && v->b != NULL && v->scratch != NULL && v->weight != NULL &&
                v->group != NULL && v->at.difference != NULL && v->at.square != NULL;
    for (int c = 0; c < 2 && made; c++) {
        v->axes[c].edge = malloc(nb * sizeof *v->axes[c].edge);
        made = v->axes[c].edge != NULL && scores_init(&v->axes[c].scores, bins, NULL) == SHEAR_OK;
    }
    if (!made) {
        solver_deinit(v);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory to symmetrize %zu stamps", n);
    }
    return SHEAR_OK;
}

/* Groups, and weights as whole numbers; false where none is positive. */
static bool set_weights(solver *v) {
    double largest = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < v->s->n; i++) {
        const symmetry_terms *t = &v->s->stamps[i];
        v->group[i] = fold_group(t->n1, t->n2);
        largest = fmax(largest, t->weight);
    }
    for (size_t i = 0; i < v->s->n && largest > 0.0; i++) {
        const double part = v->s->stamps[i].weight / largest;
        v->weight[i] = (int32_t)lround(part * SHEAR_SYMMETRY_WEIGHTS);
        sum += v->weight[i]; /* of whole numbers: exact */
        squares += (double)v->weight[i] * v->weight[i];
    }
    const int terms = squares > 0.0 ? scores_terms(sum * sum / squares) : 0;
    v->axes[0].scores.terms = v->axes[1].scores.terms = terms;
    return largest > 0.0;
}

/* The terms of stamp i without the excess of its noise over its noise stamp's. */
static symmetry_terms terms_of(const solver *v, size_t i) {
    symmetry_terms t = v->s->stamps[i];
    t.n1 -= t.excess * v->shape.n1;
    t.n2 -= t.excess * v->shape.n2;
    t.d -= t.excess * v->shape.d;
    t.u -= t.excess * v->shape.u;
    t.v -= t.excess * v->shape.v;
    return t;
}

/* Values and responses of component c (0, 1), the other component held where it is. */
static fold fold_of(solver *v, int c) {
    const double other = v->axes[1 - c].g;
    for (size_t i = 0; i < v->s->n; i++) {
        const symmetry_terms t = terms_of(v, i);
        v->x[i] = (c == 0 ? t.n1 : t.n2) - other * t.v;
        v->b[i] = c == 0 ? t.d + t.u : t.d - t.u;
    }
    return (fold){.n = v->s->n,
                  .x = v->x,
                  .b = v->b,
                  .weight = v->weight,
                  .group = v->group,
                  .bins = v->bins,
                  .edge = v->axes[c].edge};
}

/* A function of g that falls through 0, steps and all. */
typedef struct falling {
    double (*at)(const struct falling *f, double g);
    const fold *fold;
    double level; /* of the balance */
    solver *v;    /* of the score */
    const axis *axis;
} falling;

/* The root between `low`, where the function is above 0, and `high`, where it is not: false
 * position with the Illinois rule, until two steps differ by less than `tolerance`. */
static double find_fall(const falling *f, double low, double high, double tolerance) {
    double at_low = f->at(f, low);
    double at_high = f->at(f, high);
    double g = low;
    for (int i = 0, side = 0; i < MAX_STEPS && high - low > tolerance; i++) {
        const double before = g;
        const double margin = 1e-3 * (high - low);
        g = (low * at_high - high * at_low) / (at_high - at_low);
        g = fmax(low + margin, fmin(high - margin, g));
        if (fabs(g - before) < tolerance) {
            break;
        }
        const double at = f->at(f, g);
        if (at > 0.0) {
            low = g;
            at_low = at;
            at_high *= side > 0 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = g;
            at_high = at;
            at_low *= side < 0 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return g;
}

static double balance_at(const falling *f, double g) {
    return (double)fold_balance(f->fold, g) - f->level;
}

/* Where the balance falls through `level`; for 0, the weighted median of x/b: a first guess that no
 * bright galaxy can spoil. False where it does not within |g| < 1. */
static bool find_balance(const fold *f, double level, double *g) {
    const falling balance = {.at = balance_at, .fold = f, .level = level};
    if (balance_at(&balance, -widest) <= 0.0 || balance_at(&balance, widest) > 0.0) {
        return false;
    }
    *g = find_fall(&balance, -widest, widest, guess_tolerance);
    return true;
}

/* Where `scatter` of the weight has changed sides, below (sign -1) or above g; where noise in the
 * responses keeps the balance smaller than that up to |g| = 1, half of what it reaches. */
static bool find_scatter(const fold *f, double sign, double *g) {
    int64_t all = 0;
    for (size_t i = 0; i < f->n; i++) {
        all += f->weight[i];
    }
    const double most = fmax(0.0, -sign * (double)fold_balance(f, sign * widest));
    const double level = fmin(scatter * (double)all, 0.5 * most);
    return find_balance(f, -sign * level, g);
}

/* Bins about a.g, and the scores. */
static bool set_scores(solver *v, axis *a, const fold *f) {
    double low;
    double high;
    if (!find_scatter(f, -1.0, &low) || !find_scatter(f, 1.0, &high) || !(high > low)) {
        return false;
    }
    fold_quantiles(f, a->g, v->scratch, a->edge);
    a->width = 0.5 * (high - low);
    scores_fit(&a->scores, f, a->g, a->width);
    return true;
}

/* S, and the variance that the stamps' random signs give it. */
static double score_at(solver *v, const axis *a, const fold *f, double g, double *variance) {
    const double *score = a->scores.all;
    double sum = 0.0;
    *variance = 0.0;
    fold_count(f, g, &v->at);
    for (int i = 0; i < v->bins; i++) {
        sum += score[i] * (double)v->at.difference[i];
        *variance += score[i] * score[i] * (double)v->at.square[i];
    }
    return sum;
}

/* First guesses, bins and scores of both components. */
static bool begin(solver *v) {
    for (int round = 0; round < 2; round++) {
        for (int c = 0; c < 2; c++) {
            axis *a = &v->axes[c];
            const fold f = fold_of(v, c);
            if (!find_balance(&f, 0, &a->g) || (round == 1 && !set_scores(v, a, &f))) {
                return false;
            }
        }
    }
    return true;
}

/* The slope of S about its root, and sigma: over a range where neither steps nor S's bend matter.
 */
static bool set_slope(solver *v, axis *a, const fold *f) {
    const double half = fmin(0.5 * a->width, fmax(0.2 * a->width, 5.0 * a->sigma));
    double variance;
    score_at(v, a, f, a->g, &variance);
    a->slope = scores_slope(&a->scores, f, a->g, half);
    a->sigma = sqrt(variance) / a->slope;
    return a->slope > 0.0 && variance > 0.0;
}

/* From g outwards, in growing steps to the side `sign`, to where S has the sign of -`sign`. */
static bool find_side(solver *v, const axis *a, const fold *f, double sign, double step,
                      double *g) {
    double variance;
    *g = a->g + sign * step;
    while (fabs(*g) < 2.0 * widest) {
        if (sign * score_at(v, a, f, *g, &variance) < 0.0) {
            return true;
        }
        step *= 2.0;
        *g += sign * step;
    }
    return false;
}

static double score_of(const falling *f, double g) {
    double variance;
    return score_at(f->v, f->axis, f->fold, g, &variance);
}

/* The root of S, looked for about g first. */
static bool find_root(solver *v, axis *a, const fold *f, double step) {
    const falling score = {.at = score_of, .fold = f, .v = v, .axis = a};
    double low;
    double high;
    if (!find_side(v, a, f, -1.0, step, &low) || !find_side(v, a, f, 1.0, step, &high)) {
        return false;
    }
    a->g = find_fall(&score, low, high, 0.1 * still * a->sigma);
    return true;
}

/* With the best of scores S varies by as much as it falls: sigma before the slope is known. */
static bool guess_sigma(solver *v, axis *a, const fold *f) {
    double information;
    score_at(v, a, f, a->g, &information);
    a->sigma = 1.0 / sqrt(information);
    return information > 0.0;
}

static bool solve_axis(solver *v, int c) {
    axis *a = &v->axes[c];
    const fold f = fold_of(v, c);
    const bool first = !(a->sigma > 0.0);
    if (first && !guess_sigma(v, a, &f)) {
        return false;
    }
    return find_root(v, a, &f, first ? a->sigma : 0.1 * a->sigma);
}

static bool alternate(solver *v) {
    for (int round = 0; round < MAX_ROUNDS; round++) {
        double moved = 0.0;
        for (int c = 0; c < 2; c++) {
            const double before = v->axes[c].g;
            if (!solve_axis(v, c)) {
                return false;
            }
            moved = fmax(moved, fabs(v->axes[c].g - before) / v->axes[c].sigma);
        }
        if (moved < still) {
            break;
        }
    }
    for (int c = 0; c < 2; c++) {
        const fold f = fold_of(v, c);
        if (!set_slope(v, &v->axes[c], &f)) {
            return false;
        }
    }
    return true;
}

/* Covariance of the two shears: a stamp moves each by its score over the slope. */
static int covariance(solver *v, double *cov12, shear_error *err) {
    const size_t nb = (size_t)v->bins;
    int64_t *joint = calloc(nb * nb, sizeof *joint); /* w^2, by both bins, with both signs */
    if (joint == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %zu bins", nb * nb);
    }
    int bin[2] = {0, 0};
    const fold f[2] = {{.bins = v->bins, .edge = v->axes[0].edge},
                       {.bins = v->bins, .edge = v->axes[1].edge}};
    for (size_t i = 0; i < v->s->n; i++) {
        const symmetry_terms t = terms_of(v, i);
        const double g1 = v->axes[0].g;
        const double g2 = v->axes[1].g;
        const double value[2] = {t.n1 - g1 * (t.d + t.u) - g2 * t.v,
                                 t.n2 - g2 * (t.d - t.u) - g1 * t.v};
        const int64_t w = v->weight[i];
        bin[0] = fold_bin(&f[0], fabs(value[0]));
        bin[1] = fold_bin(&f[1], fabs(value[1]));
        joint[(size_t)bin[0] * nb + (size_t)bin[1]] +=
            (value[0] > 0.0) == (value[1] > 0.0) ? w * w : -w * w;
    }
    double sum = 0.0;
    for (size_t i = 0; i < nb; i++) {
        for (size_t k = 0; k < nb; k++) {
            sum += v->axes[0].scores.all[i] * v->axes[1].scores.all[k] * (double)joint[i * nb + k];
        }
    }
    free(joint);
    *cov12 = sum / (v->axes[0].slope * v->axes[1].slope);
    return SHEAR_OK;
}

static int solve(solver *v, shear_result *out, shear_error *err) {
    if (!set_weights(v) || !begin(v) || !alternate(v)) {
        return SHEAR_OK;
    }
    const int code = covariance(v, &out->cov12, err);
    if (code == SHEAR_OK) {
        out->valid = true;
        out->g1 = v->axes[0].g;
        out->g2 = v->axes[1].g;
        out->g1_err = v->axes[0].sigma;
        out->g2_err = v->axes[1].sigma;
    }
    return code;
}

/* Does the mean say that there are no galaxies to be symmetric? Somewhat too little signal for the
 * mean may be enough here; but noise alone has a symmetry, too. */
static bool hopeless(const shear_result *mean) {
    static const double least_signal = 3.0;
    return mean->why != SHEAR_HAS_SHEAR &&
           !(mean->why == SHEAR_NO_SIGNAL && mean->signal >= least_signal);
}

int symmetry_solve(const shear_symmetry *s, int bins, const noise_shape *shape, shear_result *out,
                   shear_error *err) {
    if (bins < 0 || bins > SHEAR_SYMMETRY_MAX_BINS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "%d bins: 1 to %d are possible", bins,
                          SHEAR_SYMMETRY_MAX_BINS);
    }
    out->estimator = SHEAR_ESTIMATOR_PDF_SYM;
    out->valid = false;
    out->jackknife = 0;
    out->g1 = out->g2 = out->g1_err = out->g2_err = out->cov12 = NAN;
    if (hopeless(out)) {
        return SHEAR_OK;
    }
    out->why = SHEAR_NO_SYMMETRY;
    const size_t wanted = bins > 0 ? (size_t)bins : SHEAR_SYMMETRY_BINS;
    const size_t most = s->n / PER_BIN;
    if (most == 0) {
        return SHEAR_OK;
    }
    solver v;
    int code = solver_init(&v, s, (int)(wanted < most ? wanted : most), err);
    if (code == SHEAR_OK) {
        v.shape = *shape;
        code = solve(&v, out, err);
        solver_deinit(&v);
    }
    out->why = out->valid ? SHEAR_HAS_SHEAR : SHEAR_NO_SYMMETRY;
    return code;
}

int shear_symmetry_solve(const shear_symmetry *s, int bins, shear_result *out, shear_error *err) {
    const noise_shape none = {0};
    return symmetry_solve(s, bins, &none, out, err);
}

int shear_estimate(enum shear_estimator estimator, const shear_field_sums *sums,
                   const shear_symmetry *terms, shear_result *out, shear_error *err) {
    shear_result symmetric;
    shear_field_result(sums, out);
    if (!shear_estimator_is_symmetric(estimator)) {
        return SHEAR_OK;
    }
    symmetric = *out;
    const noise_shape shape = noise_shape_of(sums);
    const int code = symmetry_solve(terms, 0, &shape, &symmetric, err);
    if (code == SHEAR_OK) {
        *out = symmetric;
        out->estimator = estimator;
    }
    return code;
}

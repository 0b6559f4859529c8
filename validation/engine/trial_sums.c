/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/trial_sums.h"

#include "engine/must.h"

#include <math.h>
#include <stdlib.h>

/* m along the shear, m and c by component, g(+) and g(-) */
enum { N_VALUES = 9, FIELDS = 16 };

trial_sums *trial_sums_new(int groups, enum shear_estimator estimator) {
    trial_sums *s = must_allocate(1, sizeof *s, "sums");
    const size_t n = 2 * (size_t)groups;
    s->groups = groups;
    s->estimator = estimator;
    s->sums = must_allocate(n, sizeof(shear_field_sums *), "sums");
    s->terms = must_allocate(n, sizeof(shear_symmetry *), "terms");
    for (size_t i = 0; i < n; i++) {
        must(shear_field_sums_new(&s->sums[i], &must_error));
        if (shear_estimator_is_symmetric(estimator))
            must(shear_symmetry_new(&s->terms[i], &must_error));
    }
    return s;
}

void trial_sums_free(trial_sums *s) {
    for (int i = 0; i < 2 * s->groups; i++) {
        shear_field_sums_free(s->sums[i]);
        shear_symmetry_free(s->terms[i]);
    }
    free(s->sums);
    free(s->terms);
    free(s);
}

/* The groups [from, to), or all others. */
typedef struct part {
    int from, to;
    bool without;
} part;

static part whole(const trial_sums *s) {
    return (part){0, s->groups, false};
}

static shear_result result_of(const trial_sums *s, int sign, part p) {
    shear_field_sums *sums = NULL;
    shear_symmetry *terms = NULL;
    shear_result result;
    must(shear_field_sums_new(&sums, &must_error));
    if (s->terms[0] != NULL)
        must(shear_symmetry_new(&terms, &must_error));
    for (int i = 0; i < s->groups; i++) {
        const int at = sign * s->groups + i;
        const bool inside = i >= p.from && i < p.to;
        if (inside == p.without)
            continue;
        shear_field_sums_join(sums, s->sums[at]);
        if (terms != NULL)
            must(shear_symmetry_join(terms, s->terms[at], 0, &must_error));
    }
    must(shear_estimate(s->estimator, sums, terms, &result, &must_error));
    shear_symmetry_free(terms);
    shear_field_sums_free(sums);
    return result;
}

shear_result trial_sums_result(const trial_sums *s, int sign) {
    return result_of(s, sign, whole(s));
}

static void combine(const double g[2], const shear_result *plus, const shear_result *minus,
                    double v[N_VALUES]) {
    const double p[2] = {plus->g1, plus->g2};
    const double q[2] = {minus->g1, minus->g2};
    const double square = g[0] * g[0] + g[1] * g[1];
    v[0] = -1.0;
    for (int i = 0; i < 2; i++) {
        const double half = 0.5 * (p[i] - q[i]);
        v[0] += half * g[i] / square;
        v[1 + i] = half / g[i] - 1.0;
        v[3 + i] = 0.5 * (p[i] + q[i]);
        v[5 + i] = p[i];
        v[7 + i] = q[i];
    }
}

static void values_of(const trial_sums *s, const trial *t, part p, double v[N_VALUES]) {
    const shear_result plus = result_of(s, 0, p);
    const shear_result minus = result_of(s, 1, p);
    combine(t->g, &plus, &minus, v);
}

/* Return the number of pieces, and set the factor that converts their scatter to an error. For the
 * mean this is a jackknife over the groups. For the symmetric estimators the pieces are independent
 * fields: their result changes in small steps, which a jackknife would multiply by the square root
 * of the number of groups. */
static int pieces_of(const trial_sums *s, double *factor) {
    const int fields = s->groups < FIELDS ? s->groups : FIELDS;
    const int n = s->terms[0] != NULL ? fields : s->groups;
    *factor = s->terms[0] != NULL ? 1.0 / (n * (n - 1.0)) : (n - 1.0) / n;
    return n;
}

static part piece(const trial_sums *s, int n, int i) {
    return (part){s->groups * i / n, s->groups * (i + 1) / n, s->terms[0] == NULL};
}

/* Return the error of value number `which` from the scatter of v [n][N_VALUES]. */
static double error_of(const double *v, int n, int which, double factor) {
    double mean = 0.0;
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        mean += v[(size_t)i * N_VALUES + (size_t)which] / n;
    for (int i = 0; i < n; i++)
        sum += pow(v[(size_t)i * N_VALUES + (size_t)which] - mean, 2.0);
    return sqrt(factor * sum);
}

static void fill_errors(const double *v, int n, double factor, int64_t stamps, trial_outcome *out) {
    double square = 0.0;
    out->m_err = error_of(v, n, 0, factor);
    for (int i = 0; i < 2; i++) {
        out->m_of_err[i] = error_of(v, n, 1 + i, factor);
        out->c_err[i] = error_of(v, n, 3 + i, factor);
    }
    for (int i = 5; i < N_VALUES; i++)
        square += 0.25 * pow(error_of(v, n, i, factor), 2.0);
    out->error = sqrt(square * (double)stamps);
    /* two components; the two signs are almost the same */
    out->error_err = out->error / sqrt(4.0 * (n - 1.0));
}

static void fill_values(const trial_sums *s, const trial *t, trial_outcome *out) {
    const shear_result r[2] = {trial_sums_result(s, 0), trial_sums_result(s, 1)};
    double v[N_VALUES];
    combine(t->g, &r[0], &r[1], v);
    out->m = v[0];
    out->quoted = 0.0;
    out->level = r[0].noise_level;
    out->level_err = r[0].noise_level_err;
    for (int i = 0; i < 2; i++) {
        out->m_of[i] = v[1 + i];
        out->c[i] = v[3 + i];
        out->used += (double)r[i].n_used;
        out->flagged += (double)r[i].n_flagged;
        out->quoted += 0.25 * (r[i].g1_err + r[i].g2_err) * sqrt((double)t->stamps);
    }
}

void trial_sums_conclude(const trial_sums *s, const trial *t, trial_outcome *out) {
    if (s->refused) {
        out->m = out->m_err = out->error = out->error_err = out->quoted = NAN;
        out->level = out->level_err = NAN;
        for (int i = 0; i < 2; i++)
            out->m_of[i] = out->m_of_err[i] = out->c[i] = out->c_err[i] = NAN;
        return;
    }
    double factor;
    const int n = pieces_of(s, &factor);
    CLEANUP(release_free) double *v = must_allocate((size_t)n * N_VALUES, sizeof *v, "errors");
    for (int i = 0; i < n; i++)
        values_of(s, t, piece(s, n, i), v + (size_t)i * N_VALUES);
    fill_errors(v, n, factor, t->stamps, out);
    fill_values(s, t, out);
}

static double shift_of(const trial_sums *s, const trial_sums *reference, const trial *t, part p) {
    double v[N_VALUES];
    double w[N_VALUES];
    values_of(s, t, p, v);
    values_of(reference, t, p, w);
    return v[0] - w[0];
}

void trial_sums_shift(const trial_sums *s, const trial_sums *reference, const trial *t,
                      double *shift, double *shift_err) {
    double factor;
    const int n = pieces_of(s, &factor);
    CLEANUP(release_free) double *v = must_allocate((size_t)n * N_VALUES, sizeof *v, "errors");
    for (int i = 0; i < n; i++)
        v[(size_t)i * N_VALUES] = shift_of(s, reference, t, piece(s, n, i));
    *shift = shift_of(s, reference, t, whole(s));
    *shift_err = error_of(v, n, 0, factor);
}

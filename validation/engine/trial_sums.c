/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/trial_sums.h"
#include "engine/must.h"

#include <math.h>
#include <stdlib.h>

/* m along the shear, m by component, c by component, g(+) and g(-). */
enum { N_VALUES = 9, FIELDS = 16 };

int harvest_init(harvest *h, int groups, enum shear_estimator estimator, shear_error *err) {
    int code = SHEAR_OK;
    const size_t n = 2 * (size_t)groups;
    *h = (harvest){.groups = groups, .estimator = estimator};
    h->sums = memory_new(n, sizeof *h->sums, "sums", &code, err);
    h->terms = memory_new(n, sizeof *h->terms, "terms", &code, err);
    for (size_t i = 0; code == SHEAR_OK && i < n; i++) {
        code = shear_field_sums_new(&h->sums[i], err);
        if (code == SHEAR_OK && shear_estimator_is_symmetric(estimator)) {
            code = shear_symmetry_new(&h->terms[i], err);
        }
    }
    return code;
}

void harvest_deinit(harvest *h) {
    for (int i = 0; i < 2 * h->groups; i++) {
        if (h->sums != NULL) {
            shear_field_sums_free(h->sums[i]);
        }
        if (h->terms != NULL) {
            shear_symmetry_free(h->terms[i]);
        }
    }
    free(h->sums);
    free(h->terms);
    *h = (harvest){0};
}

/* The groups [from, to), or all but them. */
struct choice {
    int from, to;
    bool without;
};

static int result_of(const harvest *h, int sign, struct choice c, shear_result *result,
                     shear_error *err) {
    shear_field_sums *sums = NULL;
    shear_symmetry *terms = NULL;
    int code = shear_field_sums_new(&sums, err);
    if (code == SHEAR_OK && h->terms[0] != NULL) {
        code = shear_symmetry_new(&terms, err);
    }
    for (int i = 0; code == SHEAR_OK && i < h->groups; i++) {
        const int at = sign * h->groups + i;
        const bool inside = i >= c.from && i < c.to;
        if (inside != c.without) {
            shear_field_sums_join(sums, h->sums[at]);
            code = terms != NULL ? shear_symmetry_join(terms, h->terms[at], 0, err) : SHEAR_OK;
        }
    }
    code = code != SHEAR_OK ? code : shear_estimate(h->estimator, sums, terms, result, err);
    shear_symmetry_free(terms);
    shear_field_sums_free(sums);
    return code;
}

int harvest_result(const harvest *h, int sign, shear_result *result, shear_error *err) {
    return result_of(h, sign, (struct choice){0, h->groups, false}, result, err);
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

static int values_of(const harvest *h, const struct trial *t, struct choice c, double v[N_VALUES],
                     shear_error *err) {
    shear_result plus, minus;
    int code = result_of(h, 0, c, &plus, err);
    code = code != SHEAR_OK ? code : result_of(h, 1, c, &minus, err);
    if (code == SHEAR_OK) {
        combine(t->g, &plus, &minus, v);
    }
    return code;
}

/* How many pieces there are, and what makes an error of their scatter. The mean: a jackknife of the
 * groups. The symmetry: independent fields, for its answer moves in small steps, and a jackknife
 * would take these for the root of the groups' number times as much as they are. */
static int pieces_of(const harvest *h, double *factor) {
    const int fields = h->groups < FIELDS ? h->groups : FIELDS;
    const int n = h->terms[0] != NULL ? fields : h->groups;
    *factor = h->terms[0] != NULL ? 1.0 / (n * (n - 1.0)) : (n - 1.0) / n;
    return n;
}

static struct choice piece(const harvest *h, int n, int i) {
    return (struct choice){h->groups * i / n, h->groups * (i + 1) / n, h->terms[0] == NULL};
}

/* Scatter of the values v [n][N_VALUES]. */
static double spread(const double *v, int n, int which, double factor) {
    double mean = 0.0;
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        mean += v[(size_t)i * N_VALUES + (size_t)which] / n;
    }
    for (int i = 0; i < n; i++) {
        sum += pow(v[(size_t)i * N_VALUES + (size_t)which] - mean, 2.0);
    }
    return sqrt(factor * sum);
}

static void fill_errors(const double *v, int n, double factor, int64_t stamps, trial_outcome *out) {
    double square = 0.0;
    out->m_err = spread(v, n, 0, factor);
    for (int i = 0; i < 2; i++) {
        out->m_of_err[i] = spread(v, n, 1 + i, factor);
        out->c_err[i] = spread(v, n, 3 + i, factor);
    }
    for (int i = 5; i < N_VALUES; i++) {
        square += 0.25 * pow(spread(v, n, i, factor), 2.0);
    }
    out->error = sqrt(square * (double)stamps);
    /* Two components; the two signs hardly differ. */
    out->error_err = out->error / sqrt(4.0 * (n - 1.0));
}

static int fill_values(const harvest *h, const struct trial *t, trial_outcome *out,
                       shear_error *err) {
    shear_result r[2];
    double v[N_VALUES];
    int code = harvest_result(h, 0, &r[0], err);
    code = code != SHEAR_OK ? code : harvest_result(h, 1, &r[1], err);
    if (code != SHEAR_OK) {
        return code;
    }
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
    return SHEAR_OK;
}

int harvest_judge(const harvest *h, const struct trial *t, trial_outcome *out, shear_error *err) {
    int code = SHEAR_OK;
    out->m = out->m_err = out->error = out->error_err = out->quoted = NAN;
    out->level = out->level_err = NAN;
    for (int i = 0; i < 2; i++) {
        out->m_of[i] = out->m_of_err[i] = out->c[i] = out->c_err[i] = NAN;
    }
    if (h->refused) {
        return SHEAR_OK;
    }
    double factor;
    const int n = pieces_of(h, &factor);
    double *v = memory_new((size_t)n * N_VALUES, sizeof *v, "errors", &code, err);
    for (int i = 0; code == SHEAR_OK && i < n; i++) {
        code = values_of(h, t, piece(h, n, i), v + (size_t)i * N_VALUES, err);
    }
    if (code == SHEAR_OK) {
        fill_errors(v, n, factor, t->stamps, out);
        code = fill_values(h, t, out, err);
    }
    free(v);
    return code;
}

/* v[0] += sign m */
static int add_m(const harvest *h, const struct trial *t, struct choice c, double sign, double *v,
                 shear_error *err) {
    double values[N_VALUES];
    const int code = values_of(h, t, c, values, err);
    *v += code != SHEAR_OK ? 0.0 : sign * values[0];
    return code;
}

static int shift_of(const harvest *h, const harvest *reference, const struct trial *t,
                    struct choice c, double *v, shear_error *err) {
    *v = 0.0;
    const int code = add_m(h, t, c, 1.0, v, err);
    return code != SHEAR_OK ? code : add_m(reference, t, c, -1.0, v, err);
}

int harvest_shift(const harvest *h, const harvest *reference, const struct trial *t, double *shift,
                  double *shift_err, shear_error *err) {
    double factor;
    const int n = pieces_of(h, &factor);
    int code = SHEAR_OK;
    double *v = memory_new((size_t)n * N_VALUES, sizeof *v, "errors", &code, err);
    for (int i = 0; code == SHEAR_OK && i < n; i++) {
        code = shift_of(h, reference, t, piece(h, n, i), &v[(size_t)i * N_VALUES], err);
    }
    *shift_err = code != SHEAR_OK ? NAN : spread(v, n, 0, factor);
    free(v);
    const struct choice all = {0, h->groups, false};
    return code != SHEAR_OK ? code : shift_of(h, reference, t, all, shift, err);
}

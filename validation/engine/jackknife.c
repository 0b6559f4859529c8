/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/jackknife.h"

#include "engine/must.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void jackknife_sums_extend(jackknife_sums *s, int n_series, int groups) {
    assert(groups == s->groups || s->n_series == 0);
    s->groups = groups;
    s->n_series += n_series;
    s->sums = realloc(s->sums, (size_t)s->n_series * (size_t)groups * sizeof *s->sums);
    if (s->sums == NULL)
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for sums");
}

void jackknife_sums_deinit(const jackknife_sums *s) {
    free(s->sums);
}

shear_block_sums *jackknife_sums_at(const jackknife_sums *s, int series, int group) {
    assert(series >= 0 && series < s->n_series && group >= 0 && group < s->groups);
    return &s->sums[(size_t)series * (size_t)s->groups + (size_t)group];
}

void jackknife_pack(const shear_block_sums *sums, double *packed) {
    packed[0] = (double)sums->n_stamps;
    packed[1] = (double)sums->n_used;
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        packed[2 + i] = (double)sums->flagged[i];
    memcpy(packed + 2 + SHEAR_N_FLAGS, sums->hi, sizeof sums->hi);
    memcpy(packed + 2 + SHEAR_N_FLAGS + SHEAR_N_TERMS, sums->lo, sizeof sums->lo);
}

void jackknife_unpack(const double *packed, shear_block_sums *sums) {
    shear_block_sums_init(sums);
    sums->n_stamps = (int64_t)packed[0];
    sums->n_used = (int64_t)packed[1];
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        sums->flagged[i] = (int64_t)packed[2 + i];
    memcpy(sums->hi, packed + 2 + SHEAR_N_FLAGS, sizeof sums->hi);
    memcpy(sums->lo, packed + 2 + SHEAR_N_FLAGS + SHEAR_N_TERMS, sizeof sums->lo);
}

shear_result jackknife_result(const shear_block_sums *blocks, int n, int groups) {
    shear_result r;
    shear_field_sums *field = NULL;
    shear_jackknife *jack = NULL;
    must(shear_field_sums_new(&field, &must_error));
    for (int i = 0; i < n; i++)
        shear_field_sums_add(field, &blocks[i]);
    shear_field_result(field, &r);
    if (groups > 0) {
        must(shear_jackknife_new(&jack, groups, &must_error));
        for (int i = 0; i < n; i++)
            must(shear_jackknife_add(jack, &blocks[i], &must_error));
        must(shear_jackknife_finish(jack, &r, &must_error));
    }
    shear_jackknife_free(jack);
    shear_field_sums_free(field);
    return r;
}

jackknife_shear jackknife_shear_of(const jackknife_sums *s, int series, bool by_groups,
                                   const double truth[2]) {
    const shear_block_sums *groups = jackknife_sums_at(s, series, 0);
    const shear_result r = jackknife_result(groups, s->groups, by_groups ? s->groups : 0);
    return (jackknife_shear){.g = {r.g1, r.g2},
                             .err = {r.g1_err, r.g2_err},
                             .pull = {(r.g1 - truth[0]) / r.g1_err, (r.g2 - truth[1]) / r.g2_err}};
}

/* ---- functions of the totals ---- */

/* Sum the groups except `left_out` (-1: all groups). Subtracting one group from the total would be
 * inaccurate, because the sums of series nearly cancel. */
static void sum_groups(const jackknife_sums *s, int left_out, jackknife_total *totals) {
    for (int series = 0; series < s->n_series; series++) {
        double x[SHEAR_N_COMPONENTS] = {0};
        for (int group = 0; group < s->groups; group++) {
            const shear_block_sums *b = jackknife_sums_at(s, series, group);
            for (int i = SHEAR_S_COMPONENT; group != left_out && i < SHEAR_S_PRODUCT; i++)
                x[i - SHEAR_S_COMPONENT] += b->hi[i] + b->lo[i];
        }
        const shear_ratio ratio = shear_ratio_of(x);
        totals[series] = (jackknife_total){{ratio.n1 / ratio.d, ratio.n2 / ratio.d}};
    }
}

/* Compute the covariance of values [groups][n], each of which leaves out one group. */
static void covariance(int groups, int n, const double *values, double *mean, double *cov) {
    const double scale = (groups - 1.0) / groups;
    for (int i = 0; i < n; i++) {
        mean[i] = 0.0;
        for (int g = 0; g < groups; g++)
            mean[i] += values[(size_t)g * (size_t)n + (size_t)i] / groups;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double sum = 0.0;
            for (int g = 0; g < groups; g++) {
                const double *v = values + (size_t)g * (size_t)n;
                sum += (v[i] - mean[i]) * (v[j] - mean[j]);
            }
            cov[i * n + j] = scale * sum;
        }
    }
}

void jackknife_covariance(const jackknife_sums *s, jackknife_function *f, const void *context,
                          int n, double *value, double *cov) {
    if (s->groups < 2) {
        must_fail(SHEAR_E_SETTING, "give more galaxies or groups",
                  "a jackknife needs at least two groups");
    }
    const size_t size = (size_t)s->groups * (size_t)n;
    CLEANUP(release_free)
    jackknife_total *totals = must_allocate((size_t)s->n_series, sizeof *totals, "totals");
    CLEANUP(release_free) double *values = must_allocate(size, sizeof *values, "totals");
    for (int group = 0; group < s->groups; group++) {
        sum_groups(s, group, totals);
        f(totals, context, values + (size_t)group * (size_t)n);
    }
    covariance(s->groups, n, values, value, cov);
    sum_groups(s, -1, totals);
    f(totals, context, value);
}

typedef struct selected {
    int n;
    const int *series;
    const double *truth;
} selected;

static void deviations(const jackknife_total *totals, const void *context, double *out) {
    const selected *which = context;
    for (int i = 0; i < 2 * which->n; i++)
        out[i] = totals[which->series[i / 2]].g[i % 2] - which->truth[i % 2];
}

chi_square jackknife_test(const jackknife_sums *s, int n, const int *series,
                          const double truth[2]) {
    const selected which = {n, series, truth};
    const size_t size = 2 * (size_t)n;
    CLEANUP(release_free) double *d = must_allocate(size * (size + 1), sizeof *d, "a covariance");
    jackknife_covariance(s, deviations, &which, 2 * n, d, d + size);
    return chi_square_of_covariance(d, d + size, 2 * n, s->groups);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/jackknife.h"
#include "engine/must.h"

#include <stdlib.h>
#include <string.h>

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for sums");
}

int tally_new(struct tally **tally, int n_series, int groups, shear_error *err) {
    struct tally *t = calloc(1, sizeof *t);
    *tally = t;
    if (t == NULL) {
        return no_memory(err);
    }
    t->n_series = n_series;
    t->groups = groups;
    t->sums = calloc((size_t)n_series * (size_t)groups, sizeof *t->sums);
    return t->sums != NULL ? SHEAR_OK : no_memory(err);
}

void tally_free(struct tally *t) {
    if (t != NULL) {
        free(t->sums);
        free(t);
    }
}

int tally_append(struct tally *t, const struct tally *more, shear_error *err) {
    if (more->groups != t->groups) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "tallies of %d and %d groups", t->groups,
                          more->groups);
    }
    size_t old = (size_t)t->n_series * (size_t)t->groups;
    size_t added = (size_t)more->n_series * (size_t)t->groups;
    shear_block_sums *larger = realloc(t->sums, (old + added) * sizeof *larger);
    if (larger == NULL) {
        return no_memory(err);
    }
    memcpy(larger + old, more->sums, added * sizeof *larger);
    t->sums = larger;
    t->n_series += more->n_series;
    return SHEAR_OK;
}

shear_block_sums *tally_at(const struct tally *t, int series, int group) {
    return &t->sums[(size_t)series * (size_t)t->groups + (size_t)group];
}

void tally_pack(const shear_block_sums *sums, double *packed) {
    packed[0] = (double)sums->n_stamps;
    packed[1] = (double)sums->n_used;
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        packed[2 + i] = (double)sums->flagged[i];
    }
    memcpy(packed + 2 + SHEAR_N_FLAGS, sums->hi, sizeof sums->hi);
    memcpy(packed + 2 + SHEAR_N_FLAGS + SHEAR_N_TERMS, sums->lo, sizeof sums->lo);
}

void tally_unpack(const double *packed, shear_block_sums *sums) {
    shear_block_sums_init(sums);
    sums->n_stamps = (int64_t)packed[0];
    sums->n_used = (int64_t)packed[1];
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        sums->flagged[i] = (int64_t)packed[2 + i];
    }
    memcpy(sums->hi, packed + 2 + SHEAR_N_FLAGS, sizeof sums->hi);
    memcpy(sums->lo, packed + 2 + SHEAR_N_FLAGS + SHEAR_N_TERMS, sizeof sums->lo);
}

int tally_result(const struct tally *t, int series, bool jackknife, shear_result *out,
                 shear_error *err) {
    shear_field_sums *field = NULL;
    shear_jackknife *jack = NULL;
    int code = shear_field_sums_new(&field, err);
    if (code == SHEAR_OK && jackknife) {
        code = shear_jackknife_new(&jack, t->groups, err);
    }
    for (int i = 0; code == SHEAR_OK && i < t->groups; i++) {
        shear_field_sums_add(field, tally_at(t, series, i));
        code = jack != NULL ? shear_jackknife_add(jack, tally_at(t, series, i), err) : SHEAR_OK;
    }
    if (code == SHEAR_OK) {
        shear_field_result(field, out);
        code = jack != NULL ? shear_jackknife_finish(jack, out, err) : SHEAR_OK;
    }
    shear_jackknife_free(jack);
    shear_field_sums_free(field);
    return code;
}

/* ---- functions of the totals ---- */

static double term(const shear_block_sums *s, int i) {
    return s->hi[i] + s->lo[i];
}

/* Totals of series `series`, at its noise level. */
static struct total total_of(const struct tally *t, int series, int left_out) {
    double x[SHEAR_N_COMPONENTS] = {0};
    struct total total = {0};
    for (int group = 0; group < t->groups; group++) {
        const shear_block_sums *s = tally_at(t, series, group);
        for (int i = 0; group != left_out && i < SHEAR_N_COMPONENTS; i++) {
            x[i] += term(s, SHEAR_S_COMPONENT + i);
        }
        total.n += group != left_out ? (double)s->n_used : 0.0;
    }
    const shear_ratio ratio = shear_ratio_of(x);
    total.n1 = ratio.n1;
    total.n2 = ratio.n2;
    total.d = ratio.d;
    return total;
}

/* The totals without group `left_out`, or all where it is -1. Added up anew each time: what is left
 * of a difference of large sums would be too coarse where series nearly cancel. */
static void sum_groups(const struct tally *t, int left_out, struct total *totals) {
    for (int series = 0; series < t->n_series; series++) {
        totals[series] = total_of(t, series, left_out);
    }
}

static void covariance(int groups, int n, const double *values, double *mean, double *cov) {
    double scale = (groups - 1.0) / groups;
    for (int i = 0; i < n; i++) {
        mean[i] = 0.0;
        for (int g = 0; g < groups; g++) {
            mean[i] += values[(size_t)g * (size_t)n + (size_t)i] / groups;
        }
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

int tally_jackknife(const struct tally *t, tally_function *f, const void *context, int n,
                    double *value, double *cov, shear_error *err) {
    if (t->groups < 2) {
        return shear_fail(err, SHEAR_E_SETTING, "give more galaxies or groups",
                          "a jackknife needs at least two groups");
    }
    int code = SHEAR_OK;
    size_t size = (size_t)(t->groups + 1) * (size_t)n;
    struct total *totals = memory_new((size_t)t->n_series, sizeof *totals, "totals", &code, err);
    double *values = memory_new(size, sizeof *values, "totals", &code, err);
    for (int group = 0; code == SHEAR_OK && group < t->groups; group++) {
        sum_groups(t, group, totals);
        f(totals, context, values + (size_t)group * (size_t)n);
    }
    if (code == SHEAR_OK) {
        covariance(t->groups, n, values, value, cov);
        sum_groups(t, -1, totals);
        f(totals, context, value);
    }
    free(totals);
    free(values);
    return code;
}

void tally_shears(const struct total *totals, const void *n_series, double *out) {
    int n = *(const int *)n_series;
    for (int i = 0; i < n; i++) {
        out[2 * i] = totals[i].n1 / totals[i].d;
        out[2 * i + 1] = totals[i].n2 / totals[i].d;
    }
}

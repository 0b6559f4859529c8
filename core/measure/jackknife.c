/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of a field's shear from leaving out groups of its blocks in turn. */
#include "shear/sums.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The sums of a block from which a shear is computed. */
typedef struct component_sums {
    double x[SHEAR_N_COMPONENTS];
} component_sums;

struct shear_jackknife {
    int groups;
    size_t n, capacity;
    component_sums *blocks; /* [capacity], n in use: one per block */
};

int shear_jackknife_new(shear_jackknife **out, int groups, shear_error *err) {
    *out = NULL;
    if (groups < 2) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "a jackknife needs at least 2 groups, not %d",
                          groups);
    }
    *out = calloc(1, sizeof **out);
    if (*out == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a jackknife");
    (*out)->groups = groups;
    return SHEAR_OK;
}

void shear_jackknife_free(shear_jackknife *j) {
    if (j != NULL) {
        free(j->blocks);
        free(j);
    }
}

static int reserve(shear_jackknife *j, size_t n, shear_error *err) {
    return ARRAY_RESERVE(j->blocks, j->capacity, n)
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a jackknife of %zu blocks",
                            n);
}

int shear_jackknife_add(shear_jackknife *j, const shear_block_sums *b, shear_error *err) {
    TRY(reserve(j, j->n + 1, err));
    component_sums *p = &j->blocks[j->n++];
    for (int i = 0; i < SHEAR_N_COMPONENTS; i++)
        p->x[i] = b->hi[SHEAR_S_COMPONENT + i] + b->lo[SHEAR_S_COMPONENT + i];
    return SHEAR_OK;
}

int shear_jackknife_join(shear_jackknife *j, const shear_jackknife *other, shear_error *err) {
    const int code = reserve(j, j->n + other->n, err);
    if (code != SHEAR_OK || other->n == 0)
        return code;
    memcpy(j->blocks + j->n, other->blocks, other->n * sizeof *other->blocks);
    j->n += other->n;
    return SHEAR_OK;
}

static component_sums sum_blocks(const shear_jackknife *j, size_t from, size_t to) {
    component_sums sum = {0};
    for (size_t i = from; i < to; i++) {
        for (int k = 0; k < SHEAR_N_COMPONENTS; k++)
            sum.x[k] += j->blocks[i].x[k];
    }
    return sum;
}

/* A shear. */
typedef struct shear_pair {
    double g1, g2;
} shear_pair;

/* Return the shear without group g. */
static shear_pair leave_out(const shear_jackknife *j, const component_sums *all, size_t g) {
    const size_t groups = (size_t)j->groups;
    component_sums rest = sum_blocks(j, g * j->n / groups, (g + 1) * j->n / groups);
    for (int k = 0; k < SHEAR_N_COMPONENTS; k++)
        rest.x[k] = all->x[k] - rest.x[k];
    const shear_ratio ratio = shear_ratio_of(rest.x);
    return (shear_pair){.g1 = ratio.n1 / ratio.d, .g2 = ratio.n2 / ratio.d};
}

int shear_jackknife_finish(const shear_jackknife *j, shear_result *out, shear_error *err) {
    const size_t groups = (size_t)j->groups;
    if (j->n < groups) {
        return shear_fail(
            err, SHEAR_E_SETTING, "ask for fewer groups",
            "a jackknife of %zu groups needs as many blocks of %d stamps; the field has %zu",
            groups, SHEAR_BLOCK, j->n);
    }
    const component_sums all = sum_blocks(j, 0, j->n);
    shear_pair mean = {0};
    double s11 = 0.0;
    double s22 = 0.0;
    double s12 = 0.0;
    for (size_t g = 0; g < groups; g++) {
        const shear_pair left = leave_out(j, &all, g);
        mean.g1 += left.g1 / (double)groups;
        mean.g2 += left.g2 / (double)groups;
    }
    for (size_t g = 0; g < groups; g++) { /* their scatter about the mean */
        const shear_pair left = leave_out(j, &all, g);
        s11 += (left.g1 - mean.g1) * (left.g1 - mean.g1);
        s22 += (left.g2 - mean.g2) * (left.g2 - mean.g2);
        s12 += (left.g1 - mean.g1) * (left.g2 - mean.g2);
    }
    const double factor = (double)(groups - 1) / (double)groups;
    out->jackknife = j->groups;
    /* Without a shear there is no error; nor if leaving out a group leaves a denominator of 0. */
    const bool known = out->valid && isfinite(s11) && isfinite(s22);
    out->g1_err = known ? sqrt(factor * s11) : NAN;
    out->g2_err = known ? sqrt(factor * s22) : NAN;
    out->cov12 = known ? factor * s12 : NAN;
    return SHEAR_OK;
}

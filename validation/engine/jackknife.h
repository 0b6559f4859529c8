/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jackknife.h: the sums of a sample's series, group by group, and what follows from them.
 *
 * Groups are disjoint sets of galaxies, the same for all series: leaving one out at a time gives
 * the covariance of anything that is computed from the totals (shears, differences between methods,
 * m and c over several shears), with all that the series have in common cancelled as it does in the
 * numbers themselves.
 */
#ifndef VALIDATION_JACKKNIFE_H
#define VALIDATION_JACKKNIFE_H

#include "engine/statistics.h"
#include "shear/sums.h"

#include <stdbool.h>

typedef struct jackknife_sums {
    int n_series, groups;
    shear_block_sums *sums; /* [n_series][groups] */
} jackknife_sums;

jackknife_sums *jackknife_sums_new(int n_series, int groups);
void jackknife_sums_free(jackknife_sums *s);
/* Append the series of `more`, which has the same groups of the same galaxies (any, to none). */
void jackknife_sums_append(jackknife_sums *s, const jackknife_sums *more);
shear_block_sums *jackknife_sums_at(const jackknife_sums *s, int series, int group);

/* A group's sums as plain numbers, for the cache. */
enum { JACKKNIFE_PACKED = 2 + SHEAR_N_FLAGS + 2 * SHEAR_N_TERMS };
void jackknife_pack(const shear_block_sums *sums, double *packed);
void jackknife_unpack(const double *packed, shear_block_sums *sums);

/* One series' shear and its error, by libshear's exact sums: errors of the delta method, or of the
 * jackknife over the groups (which knows of rotated copies). pull: (g - truth) / err. */
typedef struct jackknife_shear {
    double g[2], err[2], pull[2];
} jackknife_shear;
jackknife_shear jackknife_shear_of(const jackknife_sums *s, int series, bool by_groups,
                                   const double truth[2]);

/* What a function of the totals may use of each series. */
typedef struct jackknife_total {
    double g[2]; /* sums of w N_i over that of w D, at the noise level */
} jackknife_total;
/* totals [n_series]; fills out [n]. */
typedef void jackknife_function(const jackknife_total *totals, const void *context, double *out);

/* value [n]: f of all groups; cov [n][n]: its jackknife covariance. Ends the program where there
 * are fewer than two groups. */
void jackknife_covariance(const jackknife_sums *s, jackknife_function *f, const void *context,
                          int n, double *value, double *cov);

/* Are the shears of so many series the true one, all together, with the covariance of them all? */
chi_square jackknife_test(const jackknife_sums *s, int n, const int *series, const double truth[2]);

#endif

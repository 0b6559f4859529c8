/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jackknife.h: the sums of a sample's series by group, and their jackknife.
 *
 * Groups are disjoint sets of galaxies, the same for all series. Leaving out one group at a time
 * gives the covariance of any function of the totals (shears, differences between methods, m and c
 * over several shears). Contributions that the series have in common cancel in it as they do in the
 * function. */
#pragma once

#include "base/cleanup.h"
#include "engine/statistics.h"
#include "shear/sums.h"

#include <stdbool.h>

typedef struct jackknife_sums {
    int n_series, groups;
    shear_block_sums *sums; /* [n_series][groups] */
} jackknife_sums;

/* Append series, not yet set, of the same groups and galaxies. *s may be {0}. */
void jackknife_sums_extend(jackknife_sums *s, int n_series, int groups);
void jackknife_sums_deinit(const jackknife_sums *s);
shear_block_sums *jackknife_sums_at(const jackknife_sums *s, int series, int group);

/* A group's sums as doubles, for the result cache. */
enum { JACKKNIFE_PACKED = 2 + SHEAR_N_FLAGS + 2 * SHEAR_N_TERMS };
void jackknife_pack(const shear_block_sums *sums, double *packed);
void jackknife_unpack(const double *packed, shear_block_sums *sums);

/* The shear of one series and its error, from libshear's exact sums: by the delta method, or by the
 * jackknife over groups (which includes the correlation of rotated copies). pull: (g - truth) /
 * err. */
typedef struct jackknife_shear {
    double g[2], err[2], pull[2];
} jackknife_shear;
jackknife_shear jackknife_shear_of(const jackknife_sums *s, int series, bool by_groups,
                                   const double truth[2]);
/* Return the result of n blocks, with errors by the jackknife over `groups` groups of them; 0: by
 * the delta method. */
shear_result jackknife_result(const shear_block_sums *blocks, int n, int groups);

/* The part of a series' sums that a function of the totals may use. */
typedef struct jackknife_total {
    double g[2]; /* sum of w N_i over sum of w D, with the noise level */
} jackknife_total;
/* Compute out [n] from totals [n_series]. */
typedef void jackknife_function(const jackknife_total *totals, const void *context, double *out);

/* Set value [n] to f of all groups, and cov [n][n] to its jackknife covariance. Ends the program if
 * there are fewer than two groups. */
void jackknife_covariance(const jackknife_sums *s, jackknife_function *f, const void *context,
                          int n, double *value, double *cov);

/* Test whether the shears of n series are the true one, with the covariance of all of them. */
chi_square jackknife_test(const jackknife_sums *s, int n, const int *series, const double truth[2]);

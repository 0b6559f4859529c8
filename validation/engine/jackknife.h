/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tally.h: the sums of a sample's series, group by group, and what follows from them.
 *
 * Groups are disjoint sets of galaxies, the same for all series: leaving one out at a time gives
 * the covariance of anything that is computed from the totals (shears, differences between methods,
 * m and c over several shears), with all that the series have in common cancelled as it does in the
 * numbers themselves.
 */
#ifndef VALIDATION_TALLY_H
#define VALIDATION_TALLY_H

#include "shear/sums.h"

#include <stddef.h>

struct tally {
    int n_series, groups;
    shear_block_sums *sums; /* [n_series][groups] */
};

int tally_new(struct tally **t, int n_series, int groups, shear_error *err);
void tally_free(struct tally *t);
/* Append the series of `more`, which has the same groups of the same galaxies. */
int tally_append(struct tally *t, const struct tally *more, shear_error *err);
shear_block_sums *tally_at(const struct tally *t, int series, int group);

/* A group's sums as plain numbers, for the ledger. */
enum { TALLY_PACKED = 2 + SHEAR_N_FLAGS + 2 * SHEAR_N_TERMS };
void tally_pack(const shear_block_sums *sums, double *packed);
void tally_unpack(const double *packed, shear_block_sums *sums);

/* One series' shear, by libshear's exact sums: errors of the delta method, or of the jackknife over
 * the groups (which knows of rotated copies). */
int tally_result(const struct tally *t, int series, bool jackknife, shear_result *out,
                 shear_error *err);

/* What a function of the totals may use of each series. */
struct total {
    double n, n1, n2, d; /* used stamps; sums of w N1, w N2, w D at the noise level */
};
/* totals [n_series]; fills out [n]. */
typedef void tally_function(const struct total *totals, const void *context, double *out);

/* value [n]: f of all groups; cov [n][n]: its jackknife covariance. SHEAR_E_SETTING where there are
 * fewer than two groups. */
int tally_jackknife(const struct tally *t, tally_function *f, const void *context, int n,
                    double *value, double *cov, shear_error *err);

/* The shears of series as a vector: out[2 i] = g1, out[2 i + 1] = g2 of series i. */
void tally_shears(const struct total *totals, const void *n_series, double *out);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trial_sums.h: what the files of a trial came to, by one way at one level: sums and terms of each
 * group, at +g and -g, and from them m, c and errors: a jackknife of the groups for the mean, the
 * scatter of 16 independent fields for pdf-sym. */
#ifndef VALIDATION_TRIAL_SUMS_H
#define VALIDATION_TRIAL_SUMS_H

#include "engine/trial.h"
#include "shear/sums.h"
#include "shear/symmetry.h"

typedef struct trial_sums {
    int groups;
    enum shear_estimator estimator;
    shear_field_sums **sums; /* [2][groups]: +g, -g */
    shear_symmetry **terms;  /* the same; NULL for the mean */
    bool refused;            /* a file was: there will be no shear */
} trial_sums;
trial_sums *trial_sums_new(int groups, enum shear_estimator estimator);
void trial_sums_free(trial_sums *s);

/* Fills m, c, errors, used, flagged; NaN where a file was refused or there is no shear. */
void trial_sums_conclude(const trial_sums *s, const trial *t, trial_outcome *out);
/* m less that of a reference, which has other stamps of the same groups, and its error: what both
 * share is no error. NaN where there is no shear. */
void trial_sums_shift(const trial_sums *s, const trial_sums *reference, const trial *t,
                      double *shift, double *shift_err);
/* The result of all groups at one sign. */
shear_result trial_sums_result(const trial_sums *s, int sign);

#endif

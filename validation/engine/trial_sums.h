/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trial_sums.h: sums and terms of the files of a trial (one level, one way) by group and sign of
 * the shear, and m, c and errors from them: by a jackknife over the groups for the mean, by the
 * scatter of 16 independent fields for pdf-sym. */
#pragma once

#include "engine/trial.h"
#include "shear/sums.h"
#include "shear/symmetry.h"

typedef struct trial_sums {
    int groups;
    enum shear_estimator estimator;
    shear_field_sums **sums; /* [2][groups]: +g, -g */
    shear_symmetry **terms;  /* the same; NULL for the mean */
    bool refused;            /* a file was refused: there will be no shear */
} trial_sums;
trial_sums *trial_sums_new(int groups, enum shear_estimator estimator);
void trial_sums_free(trial_sums *s);

/* Compute m, c, errors, used and flagged; NaN if a file was refused or there is no shear. */
void trial_sums_conclude(const trial_sums *s, const trial *t, trial_outcome *out);
/* Compute m minus that of a reference with other stamps of the same groups. What both have in
 * common does not contribute to the error. NaN if there is no shear. */
void trial_sums_shift(const trial_sums *s, const trial_sums *reference, const trial *t,
                      double *shift, double *shift_err);
/* Return the result of all groups at one sign. */
shear_result trial_sums_result(const trial_sums *s, int sign);

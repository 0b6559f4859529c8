/* SPDX-License-Identifier: GPL-3.0-or-later */
/* harvest.h: what the files of a trial came to: sums and terms of each group, at +g and -g, and
 * from them m, c and errors: a jackknife of the groups for the mean, the scatter of 16 independent
 * fields for pdf-sym. */
#ifndef VALIDATION_HARVEST_H
#define VALIDATION_HARVEST_H

#include "engine/trial.h"

#include "shear/sums.h"
#include "shear/symmetry.h"

/* One way at one level. */
typedef struct harvest {
    int groups;
    enum shear_estimator estimator;
    shear_field_sums **sums; /* [2][groups]: +g, -g */
    shear_symmetry **terms;  /* the same; NULL for the mean */
    bool refused;
} harvest;

int harvest_init(harvest *h, int groups, enum shear_estimator estimator, shear_error *err);
void harvest_deinit(harvest *h);

/* Fills m, c, errors, used, flagged; NaN where a file was refused or there is no shear. */
int harvest_judge(const harvest *h, const struct trial *t, trial_outcome *out, shear_error *err);
/* m less that of a reference, which has other stamps of the same groups, and its error: what both
 * share is no error. NaN where there is no shear. */
int harvest_shift(const harvest *h, const harvest *reference, const struct trial *t, double *shift,
                  double *shift_err, shear_error *err);
/* The result of all groups at one sign (0: +g). */
int harvest_result(const harvest *h, int sign, shear_result *result, shear_error *err);

#endif

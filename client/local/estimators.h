/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimators.h: a field's shear by the mean and by PDF symmetrization, and which one is more
 * precise. */
#pragma once

#include "shear/symmetry.h"
#include "sheard/report.h"

enum {
    ESTIMATORS_MIN = 200,    /* used stamps from which both errors are accurate to 5 % */
    ESTIMATORS_MAX = 1000000 /* stamps above which the terms are not kept only for this: 56 MB */
};

/* Return whether both estimators will be reported for a field of n_stamps, so that its terms must
 * be kept. */
bool estimators_wanted(int64_t n_stamps, enum shear_estimator estimator);

/* Set *out from a field's sums and terms: the mean, and a symmetric estimator (that of *chosen, or
 * pdf-sym if that is the mean). out->n is 0 if `terms` is NULL, if fewer than ESTIMATORS_MIN stamps
 * are used, or if one of the two gives no shear. Returns SHEAR_OK or SHEAR_E_NOMEM. */
int estimators_solve(const shear_field_sums *sums, const shear_symmetry *terms,
                     const shear_result *chosen, sheard_report_estimators *out, shear_error *err);

/* Write "pdf-sym's error is 2.1 times smaller: as if there were 4.4 times as many galaxies" into
 * buf. Returns buf. */
char *estimators_words(const sheard_report_estimators *e, char *buf, size_t size);

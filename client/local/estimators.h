/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimators.h: the same field by the mean and by PDF symmetrization, and which is more precise. */
#ifndef CLIENT_LOCAL_ESTIMATORS_H
#define CLIENT_LOCAL_ESTIMATORS_H

#include "shear/symmetry.h"
#include "sheard/report.h"

enum {
    ESTIMATORS_MIN = 200,    /* used stamps: from here on both errors are right within 5 % */
    ESTIMATORS_MAX = 1000000 /* stamps whose terms are kept only for this: 56 MB */
};

/* Will both be told of a field of so many stamps? Then keep its terms. */
bool estimators_wanted(int64_t n_stamps, enum shear_estimator estimator);

/* Fill in *out from a field's sums and terms: the mean and a symmetric estimator: that of *chosen,
 * or pdf-sym if that is the mean. out->n is 0 if `terms` is NULL, fewer than ESTIMATORS_MIN
 * stamps are used, or one of the two has no shear. SHEAR_E_NOMEM. */
int estimators_solve(const shear_field_sums *sums, const shear_symmetry *terms,
                     const shear_result *chosen, sheard_report_estimators *out, shear_error *err);

/* The error of the first over that of the second, of both components. */
double estimators_ratio(const sheard_report_estimators *e);

/* "pdf-sym's error is 2.1 times smaller: as if there were 4.4 times as many galaxies". Returns buf.
 */
char *estimators_words(const sheard_report_estimators *e, char *buf, size_t size);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/estimators.h"

#include <math.h>
#include <stdio.h>

bool estimators_wanted(int64_t n_stamps, enum shear_estimator estimator) {
    return shear_estimator_is_symmetric(estimator) ||
           (n_stamps >= ESTIMATORS_MIN && n_stamps <= ESTIMATORS_MAX);
}

int estimators_solve(const shear_field_sums *sums, const shear_symmetry *terms,
                     const shear_result *chosen, sheard_report_estimators *out, shear_error *err) {
    int code = SHEAR_OK;
    *out = (sheard_report_estimators){.n = 0};
    shear_field_result(sums, &out->of[0]);
    if (terms == NULL || !out->of[0].valid || out->of[0].n_used < ESTIMATORS_MIN)
        return SHEAR_OK;
    out->of[1] = *chosen;
    if (!shear_estimator_is_symmetric(chosen->estimator))
        code = shear_estimate(SHEAR_ESTIMATOR_PDF_SYM, sums, terms, &out->of[1], err);
    out->n = code == SHEAR_OK && out->of[1].valid ? SHEARD_REPORT_ESTIMATORS : 0;
    return code;
}

char *estimators_words(const sheard_report_estimators *e, char *buf, size_t size) {
    static const double alike = 1.05; /* smaller ratios are within the errors of 200 stamps */
    const double ratio =              /* of the errors, for both components together */
        hypot(e->of[0].g1_err, e->of[0].g2_err) / hypot(e->of[1].g1_err, e->of[1].g2_err);
    const double times = fmax(ratio, 1.0 / ratio);
    if (times < alike) {
        snprintf(buf, size, "%s and %s are equally precise, within 5 %%",
                 shear_estimator_name(e->of[0].estimator),
                 shear_estimator_name(e->of[1].estimator));
    } else {
        snprintf(buf, size,
                 "%s's error is %.3g times smaller: as if there were %.3g times as many galaxies",
                 shear_estimator_name(e->of[ratio > 1.0 ? 1 : 0].estimator), times, times * times);
    }
    return buf;
}

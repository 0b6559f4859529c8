/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of few stamps that decide a result, and of errors that disagree. */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static const double SHARE_MIN = 0.1, SHARE_STAMPS = 5.0;
static const double FEW_EFFECTIVE = 10.0;
enum { MANY = 50 };
static const double ERRORS_APART = 1.5, ERRORS_SIGMA = 3.0;
enum { LEAST_GROUPS = 10 };

const char *sheard_advice_influence(const shear_result *r, const char *top_file, char *buf,
                                    size_t size) {
    const bool one = r->top_share > SHARE_MIN && r->top_share * (double)r->n_used > SHARE_STAMPS;
    const bool few = r->n_eff < FEW_EFFECTIVE && r->n_used > MANY;
    if (!r->valid || shear_estimator_is_symmetric(r->estimator) || r->top_stamp < 0 ||
        !(one || few)) {
        return NULL;
    }
    const int n = snprintf(
        buf, size,
        "stamp %" PRId64 "%s%.200s has %.0f %% of the sum of w D, and all %" PRId64
        " stamps count as %.1f equal ones: look at it (shearctl plot --stamp %" PRId64
        "), mask it (column FLAGS) where it is no galaxy of the sample, or use --estimator pdf-sym",
        r->top_stamp, top_file != NULL ? " of " : "", top_file != NULL ? top_file : "",
        100.0 * r->top_share, r->n_used, r->n_eff, r->top_stamp);
    return n > 0 ? buf : NULL;
}

/* Return the factor by which errors must differ. A jackknife of few groups has an error itself. */
static double far_apart(int groups) {
    return fmax(ERRORS_APART, exp(ERRORS_SIGMA / sqrt(2.0 * (groups - 1))));
}

const char *sheard_advice_errors(const shear_result *r, const shear_plan_info *plan, char *buf,
                                 size_t size) {
    (void)plan;
    if (!r->valid || r->jackknife < LEAST_GROUPS)
        return NULL;
    const double r1 = r->g1_err / r->delta_g1_err;
    const double r2 = r->g2_err / r->delta_g2_err;
    const double ratio = fabs(log(r1)) > fabs(log(r2)) ? r1 : r2;
    if (!(fabs(log(ratio)) > log(far_apart(r->jackknife))))
        return NULL;
    return advice_say(
        buf, size, "the errors by the jackknife are %.2g times those of the delta method: %s",
        ratio,
        ratio < 1.0 ? "stamps that are rotated copies of each other, whose shapes cancel? or "
                      "do a few stamps dominate?"
                    : "neighbouring stamps that are not independent of each other? or do a "
                      "few stamps dominate?");
}

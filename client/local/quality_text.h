/* SPDX-License-Identifier: GPL-3.0-or-later */
/* quality_text.h: how good a result is, in a line each: the noise level, and how many stamps
 * decide.
 */
#ifndef CLIENT_LOCAL_QUALITY_TEXT_H
#define CLIENT_LOCAL_QUALITY_TEXT_H

#include "shear/plan.h"
#include "shear/sums.h"

#include <stdint.h>
#include <stdio.h>

/* What the lines need; numbers that are not known are NaN, and `top_stamp` is -1. */
typedef struct quality_lines {
    const char *noise_band;    /* shear_noise_band_name; "": not known */
    const char *interpolation; /* as resolved */
    double r_psf_px;
    bool symmetric; /* by a symmetric estimator: no sums, no effect on them */
    double noise_level, noise_level_err, noise_effect, noise_share; /* shear/sums.h */
    double n_eff, top_share;
    int64_t n_used, top_stamp;
    const char *top_file; /* of the stamp; NULL: not known, or there is only one */
} quality_lines;

quality_lines quality_text_of(const shear_result *result, const shear_plan_info *plan);

/* The lines "  level ..." and "  influence ..."; nothing of what nothing is known of. */
void quality_text_print(const quality_lines *q, FILE *out);

#endif

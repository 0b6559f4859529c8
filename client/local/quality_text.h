/* SPDX-License-Identifier: GPL-3.0-or-later */
/* quality_text.h: lines on the quality of a result: the noise level, and the influence of single
 * stamps. */
#pragma once

#include "shear/plan.h"
#include "shear/sums.h"

#include <stdint.h>
#include <stdio.h>

/* The content of the lines. Unknown numbers are NaN, an unknown `top_stamp` is -1. */
typedef struct quality_lines {
    const char *noise_band;    /* shear_noise_band_name; "": unknown */
    const char *interpolation; /* as resolved */
    double r_psf_px;
    bool symmetric; /* from a symmetric estimator: there are no sums, so no effect on them */
    double noise_level, noise_level_err, noise_effect, noise_share; /* shear/sums.h */
    double n_eff, top_share;
    int64_t n_used, top_stamp;
    const char *top_file; /* the file of `top_stamp`; NULL: unknown, or there is only one file */
} quality_lines;

/* Return the content of the lines for a result and its plan. */
quality_lines quality_text_of(const shear_result *result, const shear_plan_info *plan);

/* Print the lines "  level ..." and "  influence ..."; a line without known numbers is omitted. */
void quality_text_print(const quality_lines *q, FILE *out);

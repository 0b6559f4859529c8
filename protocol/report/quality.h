/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report/quality.h: how good a result is, as members of a report and of a validation report.
 * References as in json_text.h; null for a NULL result. */
#ifndef PROTOCOL_REPORT_QUALITY_H
#define PROTOCOL_REPORT_QUALITY_H

#include "shear/sums.h"

#include <jansson.h>

/* {"alpha", "alpha_err", "effect", "shape", "shape_err", "share"} */
json_t *report_noise_level(const shear_result *r);
/* {"n_eff", "top_share", "top_stamp", "top_file"} */
json_t *report_influence(const shear_result *r, const char *top_file);
/* The name of why there is no shear; null where there is one. */
json_t *report_no_shear(const shear_result *r);
/* {"g1", "g2"}; null where the errors are the delta method's. */
json_t *report_delta_err(const shear_result *r);

#endif

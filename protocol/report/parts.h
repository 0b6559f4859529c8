/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report/parts.h: JSON objects that several reports contain. Every json_t* is a new reference, or
 * NULL if out of memory; it is a JSON null for a NULL argument. */
#pragma once

#include "shear/plan.h"
#include "shear/sums.h"
#include "sheard/report.h"
#include "sheard/validation_report.h"

#include <jansson.h>

/* Make {"interpolation", "oversample", "beta_px", ...}: the resolved settings. */
json_t *parts_plan(const shear_plan_info *plan);
/* Make {"looked_at", "unusable", "flaws", ...}. */
json_t *parts_psf(const shear_psf_summary *psf);
/* Make {"looked_at", "found", "x", "x_err", "y", "y_err"}. */
json_t *parts_centring(const shear_centring *c);
/* Make {"alpha", "alpha_err", "effect", "shape", "shape_err", "share"}. */
json_t *parts_noise_level(const shear_result *r);
/* Make {"n_eff", "top_share", "top_stamp", "top_file"}. */
json_t *parts_influence(const shear_result *r, const char *top_file);
/* Make {"mean", "bright", "sharp", "bright_triples", "sharp_triples"}. */
json_t *parts_resolution(const shear_result *r);
/* Make the name of the reason why there is no shear; null if there is one. */
json_t *parts_no_shear(const shear_result *r);
/* Make {"g1", "g2"}. */
json_t *parts_pair(double g1, double g2);

/* Make what validate reports of an exposure. */
json_t *parts_exposure(const sheard_validation_report *v);

/* Make a file's entry in a report. With `account`, also the shape of its stamps, the summary of
 * its PSF, and where its light is. */
json_t *parts_file(const sheard_report_file *file, bool account);

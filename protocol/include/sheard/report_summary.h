/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/report_summary.h: the numbers of a result, read back from the JSON of sheard_report_json,
 * to be shown to people. */
#ifndef SHEARD_REPORT_SUMMARY_H
#define SHEARD_REPORT_SUMMARY_H

#include "shear/error.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stdint.h>

/* The values of a report. Numbers that are null or absent are NaN, counts 0, texts "". */
typedef struct sheard_report_summary {
    double g1, g1_err, g2, g2_err, cov12;
    int64_t n_stamps, n_used, n_flagged;
    int64_t flagged[SHEAR_N_FLAGS];
    int64_t jackknife; /* groups; 0: another error method */
    char estimator[16], error_method[16];
    double true_g1, true_g2, pull_g1, pull_g2;
    char no_shear[24]; /* sheard/no_shear.h */
    double noise_level, noise_level_err, noise_effect, noise_share;
    double n_eff, top_share;
    int64_t top_stamp; /* -1: none, or unknown */
    char top_file[4096];
    int64_t n_files;
    char interpolation[24], filter[24]; /* resolved settings */
    char noise_band[16];
    int64_t oversample;
    double beta_px, r_psf_px, core_px, width_px;
    double beta_sky;                                /* arcsec; NaN in the pixel frame */
    double beta_to, r_psf_to, core_to, beta_sky_to; /* largest value among the files; the smallest
                                                       is above */
    char frame[16];                                 /* of the shear: enum shear_frame, or "mixed" */
    bool core_found;
    char asked_filter[24], background[16], artefacts[16]; /* settings as requested */
    char **warnings;                                      /* [n_warnings], owned */
    int64_t n_warnings;
    double seconds;
} sheard_report_summary;

/* Parse `text`, a JSON object; unknown members are ignored. Return SHEAR_OK, SHEAR_E_FORMAT or
 * SHEAR_E_NOMEM. The caller deinits *summary after success only. */
int sheard_report_summary_parse(sheard_report_summary *summary, const char *text, shear_error *err);
void sheard_report_summary_deinit(sheard_report_summary *summary); /* a zeroed struct is accepted */

#endif

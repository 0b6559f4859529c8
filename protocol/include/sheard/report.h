/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/report.h: results as JSON, one object on one line.
 *
 * Numbers are written with 17 significant digits, so that they read back to the same bits; a number
 * that is not finite is null. In text that is not UTF-8 (file names may be any bytes), invalid
 * bytes are replaced by U+FFFD. Every object has all its keys (except estimators), in the order of
 * the structs below. */
#ifndef SHEARD_REPORT_H
#define SHEARD_REPORT_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/sums.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One file of a field's result. */
typedef struct sheard_report_file {
    const char *path;
    const char *checksum; /* hash of the content, hexadecimal */
    const char *field;    /* FIELD of the file (--field may assign the file to another field) */
    int64_t n_stamps, n_used;
    const shear_plan_info *plan; /* the resolved settings, for this file's PSF */
    double seconds;
} sheard_report_file;

/* A field's results by several estimators. */
enum { SHEARD_REPORT_ESTIMATORS = 2 };
typedef struct sheard_report_estimators {
    int n;                                     /* 0: too few stamps, or too many */
    shear_result of[SHEARD_REPORT_ESTIMATORS]; /* [n] */
} sheard_report_estimators;

/* A field's result. Nothing that it points to is changed. */
typedef struct sheard_report {
    const char *field;
    const shear_result *result;
    const shear_settings *settings;  /* as requested: "auto" stays "auto" */
    const shear_plan_info *plan;     /* the resolved settings of the first file */
    const sheard_report_file *files; /* [n_files] */
    size_t n_files;
    const char *top_file; /* the file of result->top_stamp; NULL: unknown */
    bool has_truth;       /* all files name the same truth */
    double true_g1, true_g2;
    const char *const *warnings; /* [n_warnings] */
    size_t n_warnings;
    const sheard_report_estimators *estimators; /* NULL: not reported */
    double seconds;                             /* wall clock, all files */
} sheard_report;

/* Write the report to *text, from malloc, without a newline; the caller frees it. Return SHEAR_OK
 * or SHEAR_E_NOMEM. Keys: field g1 g1_err g2 g2_err cov12 n_stamps n_used n_flagged flags{}
 * settings{} resolved{} files[] estimator ("mean" or "pdf-sym") error_method ("delta", "jackknife"
 * or "symmetry") jackknife (groups or null) truth{g1,g2} pull{g1,g2} ((measured - true)/error; null
 * without truth) delta_err{g1,g2} (null if the errors are the delta method's) no_shear
 * (sheard/no_shear.h; null if there is a shear)
 * noise_level{alpha,alpha_err,effect,shape,shape_err,share}
 * influence{n_eff,top_share,top_stamp,top_file}
 * resolution{mean,bright,sharp,bright_triples,sharp_triples} (shear/sums.h)
 * estimators{name:{g1,g1_err,g2,g2_err,cov12,error_method}} (only of `shearctl measure`: absent if
 * `estimators` is NULL; null if it is empty) filter_removed warnings[] version seconds. */
int sheard_report_json(char **text, const sheard_report *report, shear_error *err);

#endif

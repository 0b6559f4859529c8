/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/report.h: results as JSON, one object on one line.
 *
 * Numbers are written with 17 significant digits, so that they read back to the same bits; what is
 * not finite is null. Text that is not UTF-8 (file names may be anything) has its bad bytes
 * replaced by U+FFFD. Every object has all its keys, always, in the order of the structs below.
 */
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

/* One file that went into a field's result. */
typedef struct sheard_report_file {
    const char *path;
    const char *checksum; /* content hash, hex */
    const char *field;    /* FIELD as the file has it (--field may count it to another) */
    int64_t n_stamps, n_used;
    const shear_plan_info *plan; /* what the settings were resolved to for this file's PSF */
    double seconds;
} sheard_report_file;

/* One field by several estimators. */
enum { SHEARD_REPORT_ESTIMATORS = 2 };
typedef struct sheard_report_estimators {
    int n;                                     /* 0: there are not stamps enough, or too many */
    shear_result of[SHEARD_REPORT_ESTIMATORS]; /* [n] */
} sheard_report_estimators;

/* A field's result. Pointers are only read. */
typedef struct sheard_report {
    const char *field;
    const shear_result *result;
    const shear_settings *settings;  /* as asked for: "auto" stays "auto" */
    const shear_plan_info *plan;     /* as resolved, of the first file */
    const sheard_report_file *files; /* [n_files] */
    size_t n_files;
    const char *top_file; /* the file of result->top_stamp; NULL: not known */
    bool has_truth;       /* all files name the same truth */
    double true_g1, true_g2;
    const char *const *warnings; /* [n_warnings] */
    size_t n_warnings;
    const sheard_report_estimators *estimators; /* NULL: not told */
    double seconds;                             /* wall clock, all files */
} sheard_report;

/* *text is malloc'd and the caller's to free; no newline at its end. Keys: field g1 g1_err g2
 * g2_err cov12 n_stamps n_used n_flagged flags{} settings{} resolved{} files[] estimator
 * ("mean" or "pdf-sym") error_method ("delta", "jackknife" or "symmetry") jackknife (groups or
 * null) truth{g1,g2} pull{g1,g2} (null without truth; (measured - true)/error) delta_err{g1,g2}
 * (null where the errors are the delta method's) no_shear (sheard/no_shear.h; null)
 * noise_level{alpha,alpha_err,effect,shape,shape_err,share}
 * influence{n_eff,top_share,top_stamp,top_file} (shear/sums.h)
 * estimators{name:{g1,g1_err,g2,g2_err,cov12,error_method}} (of `shearctl measure` only: where they
 * are not told, the key is not there; null where there are none) filter_removed
 * warnings[] version seconds. SHEAR_E_NOMEM. */
int sheard_report_json(char **text, const sheard_report *report, shear_error *err);

/* Stamps of a field file that share a fault: how many, and the first few. */
enum { SHEARD_FAULT_SAMPLES = 8 };
typedef struct sheard_fault {
    int64_t count;
    int64_t
        first[SHEARD_FAULT_SAMPLES]; /* indices from 0; min(count, SHEARD_FAULT_SAMPLES) of them */
} sheard_fault;

/* What `shearctl validate` finds in one field file. */
typedef struct sheard_validation_report {
    const char *path;
    bool good;                     /* it would measure, at least two stamps of it */
    const char *conclusion;        /* "verdict": one line for people */
    const char *advice;            /* what to do; may be "" */
    const shear_field_info *field; /* NULL where the file could not be opened */
    const shear_settings *settings;
    const shear_plan_info *plan; /* NULL where no plan could be made */
    const char *const *warnings; /* [n_warnings] what is doubtful */
    size_t n_warnings;
    bool scanned;         /* the members below are known */
    int64_t n_measurable; /* stamps that carry no flag */
    sheard_fault flags[SHEAR_N_FLAGS];
    sheard_fault negative; /* stamps with pixels below minus the pedestal, under a log method */
    double lowest_pixel;   /* of all finite pixels, galaxy and noise */
    /* Noise stamps of pairs that neither pixels nor catalog flag: their mean pixel with its
     * error, from their scatter (NaN for less than 2), and how much pixels scatter about their own
     * stamp's mean. */
    double noise_mean, noise_mean_err, noise_rms;
    /* Rank correlation of WEIGHT with the flux of the same stamps, and whether it is beyond doubt
     * and strong: then the weights bias the shear. NaN where all weights are equal. */
    double weight_follows_flux;
    bool weight_is_suspect;
    bool measured;       /* the next one is known */
    shear_result result; /* with these settings, by the ratio of means; its estimator is theirs */
} sheard_validation_report;

/* Keys: path good verdict advice field{} settings{} resolved{} psf{} warnings[] n_measurable
 * flags{name:{count,first[]}} negative{count,first[]} lowest_pixel noise{mean,mean_err,rms}
 * weight_follows_flux no_shear noise_level{} influence{} version; null for what is not known.
 * SHEAR_E_NOMEM. */
int sheard_validation_report_json(char **text, const sheard_validation_report *report,
                                  shear_error *err);

#endif

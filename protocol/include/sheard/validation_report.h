/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/validation_report.h: what `shearctl validate` finds in one field file, as JSON (numbers
 * and texts as in sheard/report.h). */
#ifndef SHEARD_VALIDATION_REPORT_H
#define SHEARD_VALIDATION_REPORT_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/sums.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Stamps of a field file that share a fault: how many, and the first few. */
enum { SHEARD_FAULT_SAMPLES = 8 };
typedef struct sheard_fault {
    int64_t count;
    int64_t first[SHEARD_FAULT_SAMPLES]; /* indices from 0; the first `count` are set */
} sheard_fault;

/* What `shearctl validate` finds in one field file. */
typedef struct sheard_validation_report {
    const char *path;
    bool good;                     /* it would measure, at least two stamps of it */
    const char *conclusion;        /* "verdict": one line for people */
    const char *advice;            /* what to do; may be "" */
    const shear_field_info *field; /* NULL: the file could not be opened */
    const shear_settings *settings;
    const shear_plan_info *plan; /* NULL: no plan could be made */
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
     * and strong: then the weights bias the shear. NaN if all weights are equal. */
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

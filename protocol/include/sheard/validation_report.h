/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/validation_report.h: the validation report of one field file (shearctl validate) as JSON.
 * Numbers and texts are as in sheard/report.h. */
#ifndef SHEARD_VALIDATION_REPORT_H
#define SHEARD_VALIDATION_REPORT_H

#include "shear/centring.h"
#include "shear/chip.h"
#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/sums.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Most stamps listed per fault. */
enum { SHEARD_FAULT_SAMPLES = 8 };
typedef struct sheard_fault {
    int64_t count;
    int64_t first[SHEARD_FAULT_SAMPLES]; /* indices from 0 of the first stamps; min(count,
                                            SHEARD_FAULT_SAMPLES) are set */
} sheard_fault;

/* One chip of an exposure. */
typedef struct sheard_chip_report {
    shear_chip chip;
    double masked;       /* part of its pixels that are defects; NaN: unknown */
    double weight_slope; /* shear_chip_weight_slope() */
    int64_t n_extreme; /* good pixels whose sigma is below 10^-5 of the median by the weight map */
    int64_t n_measurable;           /* stamps without a flag */
    int64_t n_bright, n_sharp;      /* shear_row_is_bright(), shear_row_is_sharp() */
    int64_t n_segmented, n_unowned; /* of shear_chip_unowned() */
    int64_t flags[SHEAR_N_FLAGS];
    shear_centring centring;
} sheard_chip_report;

/* The validation report of one field file. */
typedef struct sheard_validation_report {
    const char *path;
    bool good;                     /* at least two of its stamps can be measured */
    const char *conclusion;        /* JSON key "verdict": one line for people */
    const char *advice;            /* what to do, or "" */
    const shear_field_info *field; /* NULL: the file could not be opened */
    const shear_settings *settings;
    const shear_plan_info *plan; /* NULL: no plan could be made */
    const char *const *warnings; /* [n_warnings] what is doubtful */
    size_t n_warnings;
    bool scanned;         /* the members below are set */
    int64_t n_measurable; /* stamps without a flag */
    sheard_fault flags[SHEAR_N_FLAGS];
    sheard_fault negative; /* stamps with pixels below minus the pedestal, if logs are used */
    double lowest_pixel;   /* of all finite pixels, galaxy and noise */
    /* Noise stamps of pairs that neither pixels nor catalog flag: their mean pixel, its error from
     * their scatter (NaN for less than 2 stamps), and the scatter of pixels about their own stamp's
     * mean. */
    double noise_mean, noise_mean_err, noise_rms;
    /* Rank correlation of WEIGHT with the flux of the same stamps (NaN if all weights are equal),
     * and whether it is significant and strong: then the weights bias the shear. */
    double weight_follows_flux;
    bool weight_is_suspect;
    const sheard_chip_report *chips; /* [n_chips] of an exposure */
    int n_chips;                     /* 0: no exposure */
    /* Range of the distortion's shear in the pixel frame, |g|; NaN without a WCS. */
    double distortion_min, distortion_max;
    bool measured;       /* `result` is set */
    shear_result result; /* by the ratio of means; its `estimator` is the settings' */
} sheard_validation_report;

/* Write the report. Keys: path good verdict advice field{} settings{} resolved{} psf{} warnings[]
 * n_measurable flags{name:{count,first[]}} negative{count,first[]} lowest_pixel
 * noise{mean,mean_err,rms} weight_follows_flux no_shear noise_level{} influence{} version; of
 * exposures also exposure{frame,distortion{min,max},chips[]}; null for what is unknown. Return
 * SHEAR_OK or SHEAR_E_NOMEM. */
int sheard_validation_report_json(char **text, const sheard_validation_report *report,
                                  shear_error *err);

#endif

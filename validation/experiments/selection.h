/* SPDX-License-Identifier: GPL-3.0-or-later */
/* selection.h: what the experiment `selection` found; its table and figure. */
#ifndef VALIDATION_SELECTION_H
#define VALIDATION_SELECTION_H

#include "engine/cache.h"

/* What is cut on, in the order of the figure. */
enum selection_cut {
    CUT_TRUE, /* the signal-to-noise of the unsheared galaxy */
    CUT_FLUX, /* FLUX, SNR and D of the result */
    CUT_SNR,
    CUT_APERTURE, /* flux under a round Gaussian about the stamp's centre, over its noise */
    CUT_DEEP,     /* the same of the image without noise */
    CUT_D,
    N_CUTS
};
extern const char *const selection_cuts[N_CUTS];
enum { SELECTION_ESTIMATORS = 2 };
extern const char *const selection_estimators[SELECTION_ESTIMATORS]; /* mean, pdf-sym */

typedef struct selection_outcome {
    double m, m_err;
    double shift, shift_err; /* m less that without a cut */
    double kept, threshold;  /* part of the stamps; the least value that is kept */
} selection_outcome;
enum { SELECTION_VALUES = sizeof(selection_outcome) / sizeof(double) };

/* out [N_CUTS][fractions][SELECTION_ESTIMATORS] */
int selection_report(const struct request *r, const struct ledger *ledger,
                     const selection_outcome *out, shear_error *err);

#endif

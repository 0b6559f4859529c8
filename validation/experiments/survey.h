/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey.h: what the experiment `survey` measured; its table, verdicts and figure. */
#ifndef VALIDATION_SURVEY_H
#define VALIDATION_SURVEY_H

#include "engine/cache.h"
#include "engine/trial.h"

enum { SURVEY_WAYS = 2, SURVEY_MAX_ROWS = MAX_KNOB_VALUES }; /* the mean, pdf-sym */

struct survey {
    int n, n_levels;
    int rows[SURVEY_MAX_ROWS]; /* of the table of flaws */
    trial_outcome out[SURVEY_MAX_ROWS][TRIAL_MAX_LEVELS * SURVEY_WAYS];
};

int survey_report(const struct request *r, const struct ledger *ledger, const struct survey *s,
                  shear_error *err);

#endif

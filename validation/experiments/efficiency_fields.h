/* SPDX-License-Identifier: GPL-3.0-or-later */
/* efficiency_fields.h: the fields of the experiment `efficiency`: galaxies of many fluxes, in many
 * fields, with the shear of each field by every estimator.
 *
 * A field's result is a row of numbers for the cache: EFFICIENCY_PER_CASE for each case, then the
 * counts of shapes (information.h). */
#pragma once

#include "engine/brightness.h"
#include "engine/cache.h"
#include "engine/information.h"
#include "engine/statistics.h"

/* The estimators. */
enum {
    MEAN = SHEAR_ESTIMATOR_MEAN,
    SYMMETRY = SHEAR_ESTIMATOR_PDF_SYM,
    CROSSED = SHEAR_ESTIMATOR_PDF_SYM_CROSS,
    N_ESTIMATORS
};

enum {
    MAX_CASES = 3 * MAX_VALUES,
    EFFICIENCY_PER_ESTIMATE = 4, /* g1, g2 and their errors */
    EFFICIENCY_PER_CASE = N_ESTIMATORS * 2 * EFFICIENCY_PER_ESTIMATE
};

/* Two cases per range of fluxes (without and with noise), then one per signal-to-noise of the bias.
 */
typedef struct brightness_cases {
    int n, n_ranges;
    brightness c[MAX_CASES];
    double snr[MAX_CASES]; /* NaN: no noise */
} brightness_cases;

typedef struct efficiency_fields {
    const options *options;
    brightness_cases cases;
    int count;      /* galaxies per field */
    double *values; /* [options->groups][efficiency_fields_values] */
} efficiency_fields;

/* Return how many galaxies a field has. Ends the program if they are too few. */
int efficiency_fields_count(const options *o);
/* Measure all fields, through the cache. */
void efficiency_fields_init(efficiency_fields *f, const options *o, cache *c);
void efficiency_fields_deinit(efficiency_fields *f);

/* The result of a case by one estimator. */
typedef struct efficiency_outcome {
    spread error;  /* of (g - truth) sqrt(n), both components and signs */
    double quoted; /* mean quoted error times sqrt(n) */
    double pull_width;
    spread m;   /* of the fields, for both components */
    int failed; /* fields without a shear */
} efficiency_outcome;
efficiency_outcome efficiency_fields_outcome(const efficiency_fields *f, int i_case, int estimator);

/* Return the counts of the shapes of all fields' galaxies. */
shape_counts efficiency_fields_shapes(const efficiency_fields *f);

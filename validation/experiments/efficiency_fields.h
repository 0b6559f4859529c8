/* SPDX-License-Identifier: GPL-3.0-or-later */
/* efficiency.h: the fields of experiment efficiency: galaxies at many brightnesses, in many fields,
 * each field's shear by every estimator.
 *
 * A field yields a row of numbers for the ledger, EFFICIENCY_PER_CASE for each case, then the
 * counts of shapes (information.h).
 */
#ifndef VALIDATION_EFFICIENCY_H
#define VALIDATION_EFFICIENCY_H

#include "engine/brightness.h"
#include "engine/information.h"
#include "engine/statistics.h"

/* Estimators. */
enum {
    MEAN = SHEAR_ESTIMATOR_MEAN,
    SYMMETRY = SHEAR_ESTIMATOR_PDF_SYM,
    CROSSED = SHEAR_ESTIMATOR_PDF_SYM_CROSS,
    N_KINDS
};

enum {
    MAX_CASES = 3 * MAX_KNOB_VALUES,
    EFFICIENCY_PER_KIND = 4, /* g1, g2 and their errors */
    EFFICIENCY_PER_CASE = N_KINDS * 2 * EFFICIENCY_PER_KIND
};

/* Two for each range (without and with noise), then one for each signal-to-noise of the bias. */
struct cases {
    int n, n_ranges;
    brightness c[MAX_CASES];
    double snr[MAX_CASES]; /* NaN = no noise */
};

struct fields {
    const struct request *r;
    struct cases cases;
    bright_stamps *stamps[2]; /* at the shear, and at its opposite */
    int count;                /* galaxies of a field */
    double typical_d;         /* of a galaxy of flux 1 without noise */
    shear_row *rows;          /* [cases.n][count] */
};

int fields_init(struct fields *fields, const struct request *r, shear_error *err);
void fields_deinit(struct fields *fields);
/* How many numbers a field yields. */
int fields_values(const struct fields *fields);
/* One of them, as the ledger wants it; the context is a struct fields. */
int fields_work(void *context, int field, double *values, shear_error *err);

/* What a case came to, by one estimator. */
struct outcome {
    struct spread error; /* of (g - truth) sqrt(n), both components and signs */
    double quoted;       /* mean quoted error times sqrt(n) */
    double pull_width;
    struct spread m; /* of the fields; of both components */
    int failed;      /* fields without a shear */
};

/* values [r->groups][fields_values]. */
struct outcome fields_outcome(const struct fields *fields, const double *values, int c, int kind);
/* The galaxies' shapes, of all fields. */
void fields_shapes(const struct fields *fields, const double *values, shape_counts *counts);

#endif

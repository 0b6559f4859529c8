/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/cases.h: what is timed. */
#ifndef BENCH_CASES_H
#define BENCH_CASES_H

#include "shear/plan.h"

#include <stdbool.h>

typedef struct bench_case {
    const char *name;
    int side; /* stamp, px */
    const char *interpolation;
    int oversample; /* s; 1 for none */
    double r_psf_px, r_gal_px;
    bool psf_per_stamp;
} bench_case;

extern const bench_case bench_cases[];
extern const int bench_n_cases;

/* Stamps of a case, drawn once: pairs of smooth galaxies with white noise on a background, all
 * pixels positive. */
typedef struct bench_data {
    int count;
    shear_plan *plan;
    shear_stamps stamps;
    double *galaxy, *noise, *psf;
    int32_t *psf_index;
    shear_row *rows;
} bench_data;
int bench_data_new(bench_data *data, const bench_case *c, int count, shear_error *err);
void bench_data_free(bench_data *data);

#endif

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
int bench_data_init(bench_data *data, const bench_case *c, int count, shear_error *err);
void bench_data_deinit(bench_data *data);

/* Measure all stamps `repeats` times into rows [count]. Ends the program on failure. */
void bench_data_measure(const bench_data *data, shear_workspace *ws, int repeats, shear_row *rows);
/* The same into the data's own rows: microseconds per pair, in the thread's processor time. */
double bench_data_time_pairs(const bench_data *data, shear_workspace *ws, int repeats);

#endif

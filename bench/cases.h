/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/cases.h: the cases that are timed. */
#pragma once

#include "shear/field.h"

#include <stdbool.h>

typedef struct bench_case {
    const char *name;
    int side; /* of a stamp, px */
    const char *interpolation;
    int oversample; /* s; 1: none */
    double r_psf_px, r_gal_px;
    bool psf_per_stamp;
} bench_case;

extern const bench_case bench_cases[];
extern const int bench_n_cases;

/* The stamps of a case, drawn once: smooth galaxies and noise stamps, with white noise on a
 * background, all pixels positive. */
typedef struct bench_data {
    int count;
    shear_plan *plan;
    shear_block *block; /* its first PSF is the plan's, if the stamps have none of their own */
    shear_row *rows;
} bench_data;
int bench_data_init(bench_data *data, const bench_case *c, int count, shear_error *err);
void bench_data_deinit(bench_data *data);

/* Measure all stamps `repeats` times into rows [count]. Ends the program on failure. */
void bench_data_measure(const bench_data *data, shear_workspace *ws, int repeats, shear_row *rows);
/* Do the same into the data's own rows. Returns the thread's processor time in microseconds per
 * pair. */
double bench_data_time_pairs(const bench_data *data, shear_workspace *ws, int repeats);

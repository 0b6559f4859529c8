/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/pair.h: one stamp pair and its measurement, for tests of laws. */
#ifndef TEST_PAIR_H
#define TEST_PAIR_H

#include "shear/plan.h"

/* A pair and its PSF; all arrays owned. */
typedef struct pair {
    shear_geometry geometry;
    shear_settings settings;
    double *galaxy, *noise, *psf;
} pair;

/* Zero stamps and PSF of the given sizes, default settings. */
void pair_init(pair *p, int nx, int ny, int psf_nx, int psf_ny, int psf_oversample);
void pair_deinit(pair *p);

/* Plan, measure, free. The pair must be measurable and the row unflagged: fails the test otherwise. */
shear_row pair_measure(const pair *p);
/* The same, with the plan's decisions. */
shear_row pair_measure_info(const pair *p, shear_plan_info *info);
/* The error code of planning or measuring, with the error. */
int pair_try(const pair *p, shear_row *row, shear_error *err);

/* A deterministic number in [0, 1) (splitmix64); *state is any seed. */
double uniform(uint64_t *state);
/* Smooth random blobs: a field of n Gaussians of width about `sigma` px inside the middle of the image. */
void draw_blobs(double *out, int nx, int ny, int n, double sigma, uint64_t seed);

#endif

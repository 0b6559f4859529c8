/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/pair.h: one stamp pair and its measurement, for tests of laws. */
#pragma once

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

/* Set a setting by name; the value must be accepted. */
void pair_set(pair *p, const char *name, const char *value);
/* A random scene: blobs on a positive random ground in `galaxy`, another ground in `noise`, and an
 * elliptical Gaussian PSF of scale radius about r_psf, off centre. All pixels positive, so that
 * every method takes it. */
void pair_draw(pair *p, double r_psf, uint64_t seed);

/* The names of all seven methods. */
enum { PAIR_METHODS = 7 };
extern const char *const pair_methods[PAIR_METHODS];

/* Plan, measure, free. The pair must be measurable and the row unflagged: fails the test otherwise.
 */
shear_row pair_measure(const pair *p);
/* The same, with the plan's decisions. */
shear_row pair_measure_info(const pair *p, shear_plan_info *info);
/* The error code of planning or measuring, with the error. */
int pair_try(const pair *p, shear_row *row, shear_error *err);

/* A deterministic number in [0, 1) (splitmix64); *state is any seed. */
double uniform(uint64_t *state);
/* Smooth random blobs: a field of n Gaussians of width about `sigma` px inside the middle of the
 * image. */
void draw_blobs(double *out, int nx, int ny, int n, double sigma, uint64_t seed);

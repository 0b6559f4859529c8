/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/batch.h: many random stamp pairs with catalog columns, a PSF each. */
#pragma once

#include "shear/plan.h"

/* Everything a shear_stamps may point to; all arrays owned. Positive pixels, so that every method
 * takes them. */
typedef struct batch {
    shear_geometry geometry;
    int count;
    double *galaxy, *noise; /* [count][ny][nx] */
    double *psf;            /* [count][psf_ny][psf_nx]: number 0 serves a plan with one PSF */
    double *weight, *r_gal; /* [count] */
    int32_t *psf_index, *mask;
} batch;

void batch_init(batch *b, int count, const shear_geometry *geometry, double r_psf, uint64_t seed);
void batch_deinit(batch *b);

/* The stamps without any column, for a plan with one PSF. */
shear_stamps batch_plain(const batch *b);
/* The stamps with every column, and PSFs by index. */
shear_stamps batch_full(const batch *b);

/* A plan; fails the test where it cannot be made. own_psf: each stamp brings its own. */
shear_plan *batch_plan(const batch *b, const shear_settings *settings, bool own_psf,
                       bool has_r_gal);
/* shear_measure_range over all stamps, with a workspace of its own. */
void batch_measure(const shear_plan *plan, const shear_stamps *stamps, shear_row *rows);

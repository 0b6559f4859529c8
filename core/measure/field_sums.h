/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/field_sums.h: the members of a field's exact sums, for the files that compute results. */
#pragma once

#include "exact/exact.h"
#include "shear/sums.h"

struct shear_field_sums {
    int64_t n_stamps, n_used;
    int64_t flagged[SHEAR_N_FLAGS];
    int64_t framed[SHEAR_N_FRAMES]; /* stamps of each frame */
    exact_sum *sums;                /* [SHEAR_N_TERMS] */
    shear_influence top;
};

/* The noise's moments per unit of its power at high k; zeros if there is no noise. */
typedef struct noise_shape {
    double n1, n2, d, u, v;
} noise_shape;
noise_shape noise_shape_of(const shear_field_sums *f);

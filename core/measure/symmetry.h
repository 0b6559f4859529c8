/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/symmetry.h: the inside of a field's terms, for the file that solves them. */
#ifndef SHEAR_MEASURE_SYMMETRY_H
#define SHEAR_MEASURE_SYMMETRY_H

#include "measure/field_sums.h"
#include "shear/symmetry.h"

/* What a stamp brings: N_1 responds to (g1, g2) by (d + u, v), N_2 to (g2, g1) by (d - u, v). */
typedef struct symmetry_terms {
    double n1, n2, d;
    double u, v; /* U' = -(beta^2/2) U, V' = -2 beta^2 V */
    double weight;
    double excess; /* of the galaxy's power at high k over the noise's */
} symmetry_terms;

struct shear_symmetry {
    symmetry_terms *stamps; /* [capacity], n in use */
    size_t n, capacity;
};

/* shear_symmetry_solve of terms without their excess times `shape`. */
int symmetry_solve(const shear_symmetry *s, int bins, const noise_shape *shape, shear_result *out,
                   shear_error *err);

#endif

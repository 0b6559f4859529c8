/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/symmetry.h: the members of a field's terms, for the files that solve for the shear. */
#pragma once

#include "measure/field_sums.h"
#include "shear/symmetry.h"

/* The terms of a stamp. N_1 responds to (g1, g2) by (d + u, v), N_2 to (g2, g1) by (d - u, v). */
typedef struct symmetry_terms {
    double n1, n2, d;
    double u, v; /* U' = -(beta^2/2) U, V' = -2 beta^2 V */
    double weight;
    double excess; /* excess of the galaxy stamp's power at high k over the noise stamp's */
} symmetry_terms;

struct shear_symmetry {
    symmetry_terms *stamps; /* [capacity], n in use */
    size_t n, capacity;
};

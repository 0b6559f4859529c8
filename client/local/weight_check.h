/* SPDX-License-Identifier: GPL-3.0-or-later */
/* weight_check.h: check whether WEIGHT depends on the stamps' brightness. Such weights bias the
 * shear (docs/method.md section 7). */
#pragma once

#include "local/rank.h"
#include "shear/stamp.h"
#include "shear/symmetry.h"

/* Weights and fluxes of the first RANK_MAX stamps that have a positive weight. */
typedef struct weight_check {
    double *weight, *flux; /* [capacity], n in use */
    size_t n, capacity;
} weight_check;
void weight_check_deinit(weight_check *c);

/* Add stamp pair i, if the file has weights. Its flux is the galaxy stamp's within a circle around
 * the centre, whose radius is a quarter of the side, minus the mean of the noise stamps. If out of
 * memory, the stamp is skipped. */
void weight_check_add(weight_check *c, const shear_stamps *t, int i);

/* Return the relation of WEIGHT with the power D, from a field's terms. */
rank_relation weight_check_terms(const shear_symmetry *terms);

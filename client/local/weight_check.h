/* SPDX-License-Identifier: GPL-3.0-or-later */
/* weight_check.h: is WEIGHT made of the stamps' own brightness? Such weights bias the shear
 * (docs/method.md, "Which estimator, which weights"). */
#ifndef CLIENT_LOCAL_WEIGHT_CHECK_H
#define CLIENT_LOCAL_WEIGHT_CHECK_H

#include "local/rank.h"
#include "shear/stamp.h"
#include "shear/symmetry.h"

/* Weights and fluxes of the first RANK_MAX stamps that have a positive weight. */
typedef struct weight_check {
    double *weight, *flux; /* [capacity], n in use */
    size_t n, capacity;
} weight_check;
void weight_check_deinit(weight_check *c);

/* Add stamp pair i, if the file has weights: its flux is that of the galaxy stamp within a circle
 * of a quarter of its side about the centre, over its noise stamps' mean. Without memory it is
 * passed over. */
void weight_check_add(weight_check *c, const shear_stamps *t, int i);
rank_relation weight_check_relation(const weight_check *c);

/* Of WEIGHT with the power D, from a field's terms. */
rank_relation weight_check_terms(const shear_symmetry *terms);

#endif

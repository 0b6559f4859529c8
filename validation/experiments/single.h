/* SPDX-License-Identifier: GPL-3.0-or-later */
/* single.h: what the experiment `single` measured, and the table and figures of it. */
#ifndef VALIDATION_SINGLE_H
#define VALIDATION_SINGLE_H

#include "engine/cache.h"
#include "engine/methods.h"

/* Series: method + N_METHODS * psf_sampling. */
enum { N_SERIES = N_METHODS * N_PSF_SAMPLINGS, MAX_RATIOS = 4, MAX_OBJECTS = 64 };

/* Shears of every series at every position. */
struct shears {
    int64_t n;
    double *g[2]; /* g1 and g2: [N_SERIES][n], owned */
};

struct object {
    double truth[2]; /* its shear where pixels do not matter */
    struct shears at[MAX_RATIOS];
};

/* Table and figures of all objects, of all ratios; the figures show the first object. */
int single_report(const struct request *r, const struct ledger *ledger,
                  const struct object *objects, shear_error *err);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* narrow.h: what the experiment `narrow` found; its table and figure. */
#ifndef VALIDATION_NARROW_H
#define VALIDATION_NARROW_H

#include "engine/bias_fit.h"
#include "engine/cache.h"

enum { NARROW_WAYS = 2, NARROW_DISKS = 4 };
extern const char *const narrow_ways[NARROW_WAYS]; /* the defaults, the paper's settings */
extern const double narrow_disks_px[NARROW_DISKS]; /* half-light radii; 0: a point */

typedef struct narrow_point {
    double r_psf_px, beta_px[NARROW_WAYS];
    struct bias bias[NARROW_WAYS];
    /* The aliases' share under the first way's target: of the mocks' galaxies, of disks. */
    double own, disk[NARROW_DISKS];
} narrow_point;

struct narrow {
    double limit_px; /* R_PSF at which the aliases of the smallest disks are 10^-3 */
    int n;
    narrow_point points[MAX_KNOB_VALUES];
};

int narrow_report(const struct request *r, const struct ledger *ledger, const struct narrow *n,
                  shear_error *err);

#endif

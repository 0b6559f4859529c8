/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/high_power.h: the power of a pair at the wave numbers where no galaxy has any: what is
 * left there is the noise under galaxy and noise stamp (docs/method.md, section 5). Two bands, |k|
 * from 3/4 of Nyquist to Nyquist, and the corners beyond it. Rows jy = ny/2 are left out: they
 * would cost a group of their own. Large stamps have more modes than are needed, and not all groups
 * of rows are read: the last one, and from the first on as many as make MODES. Only without
 * interpolation.
 */
#ifndef SHEAR_MEASURE_HIGH_POWER_H
#define SHEAR_MEASURE_HIGH_POWER_H

#include "measure/moments.h"

#include <stdbool.h>
#include <stddef.h>

/* Which modes count, and how much: a mode stands for its mirror image, too. Immutable. */
typedef struct high_band {
    int nx, ny;
    int last_group; /* of rows */
    size_t stride;
    int *first_jx;  /* [last_group + 1] modes of a group that count have |jx| at least this; beyond
                       nx/2: none counts */
    double *edge;   /* [nx][stride] of modes 3/4 of Nyquist <= |k| < Nyquist; NULL: only corners */
    double *corner; /* [nx][stride] of modes beyond */
    double n_edge, n_corner; /* modes of the whole plane in each */
} high_band;

/* Sums of |F|^2 over the modes. */
typedef struct high_power {
    double edge_galaxy, edge_noise, corner_galaxy, corner_noise;
} high_power;

/* false when memory is out; deinit is safe then too, and on zeros. */
bool high_band_init(high_band *b, int nx, int ny, bool corners_only);
void high_band_deinit(high_band *b);
size_t high_band_bytes(int nx, int ny, bool corners_only);
static inline bool high_band_is_set(const high_band *b) {
    return b->corner != NULL;
}

/* Does any mode of a group count? */
static inline bool high_band_wants(const high_band *b, int group) {
    return high_band_is_set(b) && group <= b->last_group && b->first_jx[group] <= b->nx / 2;
}

/* Add what the rows of one such group hold. */
void high_power_add(high_power *p, const high_band *b, const mode_rows *rows);

#endif

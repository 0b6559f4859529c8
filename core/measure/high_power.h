/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/high_power.h: the power of a pair at the wave numbers where no galaxy has any, which
 * gives the noise level.
 *
 * What is left there is the noise of the galaxy and the noise stamp (docs/method.md, section 5).
 * There are two bands: |k| from 3/4 of Nyquist to Nyquist, and the corners beyond it. Rows jy =
 * ny/2 are left out, because they would need a group of their own. Large stamps have more modes
 * than are needed; then only the last group of rows is read, and as many from the first on as
 * contain MODES modes. Only without interpolation. */
#pragma once

#include "measure/moments.h"

#include <stdbool.h>
#include <stddef.h>

/* The modes that count, and their weights (2 if a mode stands for its mirror image, too).
 * Immutable. */
typedef struct high_band {
    int nx, ny;
    int last_group; /* last group of rows */
    size_t stride;
    int *first_jx;  /* [last_group + 1] the smallest |jx| that counts in a group; beyond nx/2: none
                       counts */
    double *edge;   /* [nx][stride] weights of modes 3/4 of Nyquist <= |k| < Nyquist; NULL: corners
                       only */
    double *corner; /* [nx][stride] weights of modes beyond Nyquist */
    double n_edge, n_corner; /* number of modes in each band, in the whole plane */
} high_band;

/* Sums of |F|^2 over the modes. */
typedef struct high_power {
    double edge_galaxy, edge_noise, corner_galaxy, corner_noise;
} high_power;

/* Place the tables, and fill them unless the arena only counts. */
void high_band_place(high_band *b, int nx, int ny, bool corners_only, arena *a);
/* Return false for an all-zero band. */
static inline bool high_band_is_set(const high_band *b) {
    return b->nx > 0;
}

/* Return whether any mode of a group counts. */
static inline bool high_band_wants(const high_band *b, int group) {
    return high_band_is_set(b) && group <= b->last_group && b->first_jx[group] <= b->nx / 2;
}

/* Add the modes of one such group. */
void high_power_add(high_power *p, const high_band *b, const mode_rows *rows);

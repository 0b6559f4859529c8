/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/plateau.h: the flat power of shot noise, measured where a galaxy has no power.
 *
 * It is the mean over the modes with |k| > 3/4 of Nyquist, the corners included (Zhang, Luo &
 * Foucaud 2015). Only without interpolation, which would colour white noise. */
#pragma once

#include "measure/moments.h"

#include <stddef.h>

/* The share of each mode in the mean: 1/n, 2/n if it stands for its mirror image, too, or 0. */
typedef struct plateau {
    int nx, ny;
    int last_group; /* last group of rows */
    size_t stride;
    double *share; /* [nx][stride] jy = 0 .. ny/2 */
    double n;      /* number of modes of the whole plane that count */
} plateau;

/* Place the shares, and fill them unless the arena only counts. */
void plateau_place(plateau *p, int nx, int ny, arena *a);

/* Add the part of the mean that the rows of one group hold, and that of the noise stamp alone;
 * groups are 0 .. last_group. */
void plateau_add(const plateau *p, const mode_rows *rows, double *mean, double *noise_mean);

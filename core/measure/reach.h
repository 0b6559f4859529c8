/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/reach.h: how far a file's galaxies reach, and the smallest filter that leaves them whole
 * (filter=auto; docs/method.md, section 2). */
#ifndef SHEAR_MEASURE_REACH_H
#define SHEAR_MEASURE_REACH_H

#include <stdbool.h>

/* Rings of a pixel about the stamp's centre, out to its nearest edge, of a sample of stamps. */
typedef struct reach {
    int nx, ny;
    int n_rings;
    int capacity, count; /* stamps */
    int *ring;           /* [ny][nx], -1 beyond the last */
    double *pixels;      /* [n_rings] pixels in it */
    double *radius;      /* [n_rings] their mean distance */
    double *mean;        /* [capacity][n_rings] of each stamp, above its noise stamp's mean */
    double *sorted;      /* [capacity] scratch */
    double *profile;     /* [n_rings] */
} reach;

bool reach_init(reach *r, int nx, int ny, int capacity); /* false when memory is out */
void reach_deinit(reach *r);

/* Add a stamp pair [ny][nx]; one with a pixel that is not finite does not count. */
void reach_add(reach *r, const double *galaxy, const double *noise);

/* The smallest core, a multiple of 1/4 px and at least 2 beta, that takes less than 1e-3 of the
 * shear with a fall of this width; NaN where the stamps are too small for it, or too few or too
 * faint to tell. False when memory is out. */
bool reach_core(reach *r, double r_psf, double beta, double width, double *core);

#endif

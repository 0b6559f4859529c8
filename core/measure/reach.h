/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/reach.h: how far a file's galaxies reach, and the core of the smallest filter that
 * leaves them whole (filter=auto; docs/method.md, section 2). */
#pragma once

#include <stdbool.h>

/* Rings of one pixel about the stamp's centre, out to its nearest edge, for a sample of stamps. */
typedef struct reach {
    int nx, ny;
    int n_rings;
    int capacity, count; /* stamps */
    void *memory;        /* of all arrays */
    int *ring;           /* [ny][nx] the ring of each pixel; -1 beyond the last */
    double *pixels;      /* [n_rings] number of pixels */
    double *radius;      /* [n_rings] mean distance of its pixels, pixels */
    double *mean;        /* [capacity][n_rings] means of each stamp, above its noise stamp's mean */
    double *sorted;      /* [capacity] scratch */
    double *profile;     /* [n_rings] scratch */
} reach;

bool reach_init(reach *r, int nx, int ny, int capacity); /* false if out of memory */
void reach_deinit(reach *r);

/* Add a stamp pair [ny][nx]; a pair with a pixel that is not finite is skipped. */
void reach_add(reach *r, const double *galaxy, const double *noise);

/* Set *core to the smallest core, a multiple of 1/4 px and at least 2 beta, with which a filter of
 * this width takes less than 1e-4 of the mean profile's shear; NaN if the stamps are too small for
 * it, or too few or too faint to decide. Return false if out of memory. */
bool reach_core(reach *r, double r_psf, double beta, double width, double *core);

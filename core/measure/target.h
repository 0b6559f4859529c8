/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/target.h: the target |W_beta|^2 on the modes of a stamp, in the frame of the moments.
 *
 * Its table includes the weight of both halves of the plane (2 for jy > 0) and the factor 1/(nx ny
 * s^4), which turns sums over modes into integrals over the plane (Parseval). */
#pragma once

#include "base/arena.h"
#include "measure/frame_map.h"
#include "measure/mode_plane.h"

typedef struct target {
    frame_map map;
    double beta;   /* in the frame's unit */
    double limit;  /* |q| < limit: all modes of that |q| are in the plane */
    int jx, jy;    /* the last modes inside it; columns and groups of rows beyond are not filled */
    double *q2;    /* [2 max_jx + 1][stride] |q|^2; INFINITY beyond max_jy */
    double *power; /* [2 max_jx + 1][stride] |W_beta|^2 times the factors above */
    double *steps; /* [2][stride] scratch of target_fill_sky; NULL for the pixel frame */
} target;

/* Place the tables. */
void target_place(target *t, const mode_plane *p, bool sky, arena *a);

/* Fill the tables for the pixel frame; s fine pixels per pixel. */
void target_fill_pixel(target *t, const mode_plane *p, double beta, int s);
/* Fill them for a galaxy's map. Modes at |q| >= farthest are left out. Nothing is computed for each
 * mode but products. */
void target_fill_sky(target *t, const mode_plane *p, const frame_map *map, double beta, int s,
                     double farthest);

/* Leave out modes at |q| >= farthest in a table that has been filled. */
void target_limit(target *t, const mode_plane *p, double farthest);

/* Return the |q| beyond which x^2 exp(-x), x = (beta q)^2, over |W|^2 >= threshold is below 1e-15
 * of its largest value: no mode there counts (docs/method.md, section 3). */
double target_farthest(double beta, double threshold);

/* Return the last jx with |q| <= q in rows jy and later, and the last jy; no more than `most`. */
int target_last_jx(const target *t, const mode_plane *p, double q, int jy, int most);
int target_last_jy(const target *t, const mode_plane *p, double q, int most);

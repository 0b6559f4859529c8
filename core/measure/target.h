/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/target.h: the target |W_beta|^2 on the modes of a stamp, in the frame of the moments. */
#pragma once

#include "base/arena.h"
#include "measure/frame_map.h"
#include "measure/mode_plane.h"

/* A target, and the circle of the frame's plane in which it is seen. */
typedef struct target_aim {
    frame_map map;
    double beta;  /* in the frame's unit */
    double limit; /* |q| < limit: all modes of that |q| are in the plane */
    int jx, jy;   /* the last modes inside it */
} target_aim;

/* Return the aim; modes at |q| >= farthest do not count. */
target_aim target_aim_at(const mode_plane *p, const frame_map *map, double beta, double farthest);
/* Return the last jx with |q| <= q in rows jy and later, and the last jy; no more than `most`. */
int target_last_jx(const target_aim *t, const mode_plane *p, double q, int jy, int most);
int target_last_jy(const target_aim *t, const mode_plane *p, double q, int most);

/* Return the |q| beyond which x^2 exp(-x), x = (beta q)^2, over |W|^2 >= threshold is below 1e-15
 * of its largest value: no mode there counts (docs/method.md, section 3). */
double target_farthest(double beta, double threshold);

/* Return the factors that T has in row jy: the weight of both halves of the plane (2 for jy > 0),
 * and 1/(nx ny s^4), which turns sums over modes into integrals over the plane (Parseval). */
double target_factor(const mode_plane *p, int s, int jy);

/* The target of the pixel frame, the same for all stamps. Immutable once filled. */
typedef struct target {
    target_aim aim;
    double *k2;    /* [2 max_jx + 1][stride] k^2; INFINITY beyond max_jy */
    double *power; /* [2 max_jx + 1][stride] |W_beta|^2 times the factors above */
} target;
void target_place(target *t, const mode_plane *p, arena *a);
/* Fill the tables; s fine pixels per pixel. */
void target_fill(target *t, const mode_plane *p, double beta, int s);
